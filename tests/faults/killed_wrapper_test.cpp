// kill -9 of wrappers that need nothing installed, at random moments of a learning run.
#include "assassin.hpp"

namespace maide {
namespace {

using test::expect_same_model;

TEST(KilledWrapper, OfTheReferencePortLosesNoWord) {
  expect_same_model("maide-wrap-port", {{"kind", "strict"}, {"size", "2"}}, Translation::eager);
}

TEST(KilledWrapper, OfAFragileSystemIsNoCrashOfIts) {
  expect_same_model("fragile_wrapper", {}, Translation::av, 10);
}

TEST(KilledWrapper, WithABrokerLosesNoWord) {
  expect_same_model("fragile_wrapper", {{"death", "broker"}}, Translation::eager, 10);
}

}  // namespace
}  // namespace maide
