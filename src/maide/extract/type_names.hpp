// Names of C++ types as tables have them.
#pragma once

#include <string>
#include <string_view>

namespace maide::extract {

// The class that a type is, or points to: `const std::shared_ptr<rclcpp::Publisher<Int>> &` and
// `rclcpp::Publisher<Int>::SharedPtr` are `rclcpp::Publisher`. Template arguments are left out.
std::string class_of_type(std::string_view type);

// What stands between the first < and its >: `Int`. Empty: nothing.
std::string template_arguments(std::string_view type);

// Whether a variable of this type holds a pointer.
bool is_pointer_type(std::string_view type);

// Whether it holds a pointer that does not keep alive what it points to.
bool is_weak_type(std::string_view type);

// Numbers, characters, bool, void: nothing is called when they are used.
bool is_plain_type(std::string_view name);

// Whether it is a whole number in decimal digits.
bool is_decimal(const std::string& text);

// `ms` of milliseconds; empty: another word.
std::string unit_of_time(std::string_view word);

// `0.5s` in milliseconds, at least 1; empty: it is no such time.
std::string milliseconds_of(const std::string& time);

// The last part of a qualified name.
std::string last_part(std::string_view name);

// The qualified name without its last part.
std::string outer_part(std::string_view name);

}  // namespace maide::extract
