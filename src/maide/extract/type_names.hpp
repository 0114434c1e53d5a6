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

// Numbers, characters, bool, void: nothing is called when they are used.
bool is_plain_type(std::string_view name);

// The last part of a qualified name.
std::string last_part(std::string_view name);

// The qualified name without its last part.
std::string outer_part(std::string_view name);

}  // namespace maide::extract
