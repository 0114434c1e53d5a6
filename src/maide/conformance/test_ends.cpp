#include "maide/conformance/test_ends.hpp"

#include <array>
#include <span>

#include "maide/base/named_table.hpp"

namespace maide {
namespace {

template <typename Law>
struct NamedLaw {
  std::string_view name;
  Law law;
};

constexpr std::array prefixes{NamedLaw<PrefixStates>{"uniform", PrefixStates::uniform},
                              NamedLaw<PrefixStates>{"deep", PrefixStates::deep},
                              NamedLaw<PrefixStates>{"transitions", PrefixStates::transitions}};
constexpr std::array suffixes{NamedLaw<SuffixWords>{"own", SuffixWords::own},
                              NamedLaw<SuffixWords>{"any", SuffixWords::any},
                              NamedLaw<SuffixWords>{"none", SuffixWords::none}};

}  // namespace

PrefixStates find_prefix_states(std::string_view name) {
  return find_row(std::span<const NamedLaw<PrefixStates>>(prefixes), "law of prefixes", name).law;
}

SuffixWords find_suffix_words(std::string_view name) {
  return find_row(std::span<const NamedLaw<SuffixWords>>(suffixes), "law of suffixes", name).law;
}

}  // namespace maide
