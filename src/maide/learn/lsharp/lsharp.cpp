#include "maide/learn/lsharp/lsharp.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>
#include <variant>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/counterexample.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"

namespace maide {

TargetEstimate::TargetEstimate(const Apartness& apartness)
    : states_(apartness.size()), by_input_(apartness.input_count()), visits_(states_) {
  for (Apartness::Transition transition = 0; transition < states_ * by_input_.size();
       ++transition) {
    const StateId target = apartness.target(transition);
    if (target == Mealy::no_state) continue;
    const Symbol output = apartness.tree().output(apartness.target_node(transition));
    const bool is_loop = target == apartness.source(transition);
    by_input_[apartness.input(transition)].push_back({output, target, is_loop});
    Counts& counts = by_output_[output];
    counts.targets.resize(states_);
    (is_loop ? counts.loops : counts.targets[target]) += 1;
    visits_[target] += 1;
  }
}

bool TargetEstimate::has_seen(Symbol input, Symbol output) const {
  const std::vector<Seen>& all = by_input_[input];
  return std::ranges::any_of(all, [&](const Seen& seen) { return seen.output == output; });
}

std::vector<double> TargetEstimate::weights(std::size_t states, StateId source, Symbol input,
                                            Symbol output) const {
  std::vector<double> result;
  result.reserve(states);
  for (StateId state = 0; state < states; ++state) result.push_back(weight(state));
  if (const auto found = by_output_.find(output); found != by_output_.end()) {
    const Counts& counts = found->second;
    for (StateId state = 0; state < states_; ++state) {
      result[state] += same_output * counts.targets[state];
    }
    result[source] += loop * same_output * counts.loops;
  }
  for (const Seen& seen : by_input_[input]) {
    result[seen.target] += same_input;
    if (seen.output != output) continue;
    result[seen.is_loop ? source : seen.target] += seen.is_loop ? loop * same_both : same_both;
  }
  return result;
}

namespace {

std::size_t checked_input_count(const OutputOracle& oracle) {
  if (oracle.inputs().empty()) throw UsageError("the system has no inputs to learn from");
  return oracle.inputs().size();
}

// Planning takes time by the nodes. Of very many the likely ones are enough.
void keep_likeliest(std::vector<WeightedNode>& nodes) {
  constexpr std::size_t most_nodes = 64;
  if (nodes.size() <= most_nodes) return;
  std::ranges::stable_sort(nodes, [](const WeightedNode& left, const WeightedNode& right) {
    return left.weight > right.weight;
  });
  nodes.resize(most_nodes);
}

}  // namespace

LSharp::LSharp(OutputOracle& oracle, Separation separation)
    : oracle_(oracle), separation_(separation), apartness_(checked_input_count(oracle)) {}

void LSharp::start(const RunControl& control) {
  verify(control);
  complete(control);
}

void LSharp::ask(const std::vector<Query>& batch, const RunControl& control) {
  control.check("learning");
  const std::vector<MealyAnswer> answers = oracle_.ask(batch, control);
  MAIDE_CHECK(answers.size() == batch.size());
  output_queries_ += answers.size();
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Word& inputs = answers[i].inputs;
    const Word& outputs = answers[i].outputs;
    if (const Word* word = std::get_if<Word>(&batch[i])) complete_outputs(answers[i], *word);
    const ObservationTree::Inserted inserted = apartness_.insert(inputs, outputs);
    if (!inserted.conflict) {
      // Every query asks for something new; one that was cut short would be asked for ever.
      if (inserted.known < inputs.size()) continue;
      throw Error(ExitStatus::system_failed, "the system did not answer a query to its end");
    }
    throw contradiction(apartness_.tree(), answers[i], inserted.known, oracle_);
  }
}

// The system's last output to a word that is not empty; from the tree if it knows.
Symbol LSharp::last_output(const Word& word, const RunControl& control) {
  const ObservationTree& tree = apartness_.tree();
  if (tree.find(ObservationTree::root, word) == ObservationTree::none) ask({word}, control);
  return tree.output(tree.find(ObservationTree::root, word));
}

void LSharp::complete(const RunControl& control) {
  while (true) {
    control.check("learning");
    if (apartness_.has_isolated()) {
      apartness_.promote_isolated();
      Progress progress;
      progress.phase = "learning";
      progress.states = apartness_.size();
      progress.words = output_queries_;
      control.report(progress);
      continue;
    }
    if (rebuild(control) || extend(control) || separate(control) || doubt(control)) continue;
    hypothesis_.update(apartness_, oracle_.inputs(), oracle_.outputs());
    const std::optional<Word> conflict = hypothesis_.find_conflict(apartness_);
    if (!conflict) return;
    analyse(*conflict, control);
  }
}

// The estimate, counted again once the answers since then may matter; then plans are made anew,
// too. Shared ones rarely: what was asked in the same way everywhere tells most apart.
const TargetEstimate& LSharp::estimate() {
  if (!estimate_ || output_queries_ >= estimate_expires_) {
    estimate_.emplace(apartness_);
    common_plan_.reset();
    plans_.clear();
    const std::uint64_t transitions = apartness_.transition_count();
    estimate_expires_ = output_queries_ + (is_large() ? 10 * transitions : transitions / 24) + 1;
  }
  return *estimate_;
}

// Asks inputs in the newest state that lacks some; false if none does.
bool LSharp::extend(const RunControl& control) {
  const std::size_t inputs = apartness_.input_count();
  for (; extended_ < apartness_.size(); ++extended_) unasked_.push_back(extended_);
  while (!unasked_.empty()) {
    std::vector<Query> batch;
    for (Symbol input = 0; input < inputs && batch.size() < batch_size; ++input) {
      const auto transition = static_cast<Transition>(unasked_.back() * inputs + input);
      if (apartness_.target_node(transition) != ObservationTree::none) continue;
      batch.push_back(extension(transition));
    }
    if (!batch.empty()) {
      ask(batch, control);
      return true;
    }
    unasked_.pop_back();
  }
  return false;
}

// Asks what tells candidates apart where there are most; false if nothing is left to tell.
bool LSharp::separate(const RunControl& control) {
  struct Open {
    std::size_t candidates;
    Transition transition;
  };
  std::vector<Open> open;
  for (const FrontierClasses::Class at : apartness_.classes().update_open()) {
    const std::size_t candidates = apartness_.classes().candidates(at).size();
    MAIDE_CHECK(candidates > 1);
    apartness_.classes().for_each_member(at, [&](Transition transition) {
      open.push_back({candidates, transition});
    });
  }
  if (open.empty()) return false;
  const std::size_t count =
      std::min(open.size(), std::clamp(open.size() / 16, batch_size, largest_batch));
  const auto chosen = open.begin() + static_cast<std::ptrdiff_t>(count);
  std::partial_sort(open.begin(), chosen, open.end(), [](const Open& left, const Open& right) {
    return std::pair(right.candidates, left.transition) <
           std::pair(left.candidates, right.transition);
  });
  std::vector<Query> batch;
  for (auto next = open.begin(); next != chosen; ++next) {
    batch.push_back(separation(next->transition));
  }
  ask(batch, control);
  return true;
}

// Of an input that was not asked there yet: what follows depends on its output.
Query LSharp::extension(Transition transition) {
  if (separation_ == Separation::separating_words || apartness_.size() == 1) {
    return apartness_.word_to(transition);
  }
  DecisionTree query = path_to(transition);
  const std::size_t last = query.nodes.size() - 1;
  if (is_large()) {
    Word outputs(oracle_.outputs().size());
    std::iota(outputs.begin(), outputs.end(), Symbol{0});
    graft(query, last, outputs, common_plan());
    return query;
  }
  std::vector<StateId> all(apartness_.size());
  std::iota(all.begin(), all.end(), StateId{0});
  const Symbol input = apartness_.input(transition);
  std::optional<DecisionTree> unseen;  // for outputs that the input has not had yet
  for (Symbol output = 0; output < oracle_.outputs().size(); ++output) {
    if (estimate().has_seen(input, output)) {
      graft(query, last, output, identify(transition, output, all));
    } else {
      if (!unseen) unseen = identify(transition, output, all);
      graft(query, last, output, *unseen);
    }
  }
  return query;
}

// Of a frontier node with several candidates.
Query LSharp::separation(Transition transition) {
  const std::vector<StateId>& candidates = apartness_.candidates(transition);
  const ObservationTree& tree = apartness_.tree();
  if (separation_ == Separation::separating_words) {
    Word word = apartness_.word_to(transition);
    const Word witness =
        tree.find_witness(apartness_.node(candidates[0]), apartness_.node(candidates[1]));
    MAIDE_CHECK(!witness.empty());  // the basis is pairwise apart
    word.insert(word.end(), witness.begin(), witness.end());
    return word;
  }
  const Symbol output = tree.output(apartness_.target_node(transition));
  DecisionTree query = path_to(transition);
  graft(query, query.nodes.size() - 1, output,
        is_large() ? shared_plan(candidates) : identify(transition, output, candidates));
  return query;
}

DecisionTree LSharp::identify(Transition transition, Symbol output,
                              const std::vector<StateId>& candidates) {
  const StateId source = apartness_.source(transition);
  std::vector<double> weights =
      estimate().weights(apartness_.size(), source, apartness_.input(transition), output);
  weigh_expected(transition, output, weights);
  std::vector<WeightedNode> nodes;
  for (const StateId state : candidates) {
    nodes.push_back({apartness_.node(state), weights[state]});
  }
  return find_adaptive_sequence(apartness_.tree(), std::move(nodes), ~std::size_t{0}, &witnesses_);
}

// Of all states. Those that were found since are left out.
const DecisionTree& LSharp::common_plan() {
  const TargetEstimate& likely = estimate();
  if (common_plan_) return *common_plan_;
  std::vector<WeightedNode> nodes;
  for (StateId state = 0; state < apartness_.size(); ++state) {
    nodes.push_back({apartness_.node(state), likely.weight(state)});
  }
  common_plan_ =
      find_adaptive_sequence(apartness_.tree(), std::move(nodes), largest_plan, &witnesses_);
  return *common_plan_;
}

// Of these candidates: what it tells apart stays apart, wherever they are candidates.
const DecisionTree& LSharp::shared_plan(const std::vector<StateId>& candidates) {
  const TargetEstimate& likely = estimate();
  if (plans_.size() >= most_plans) plans_.clear();
  const auto [found, is_new] = plans_.try_emplace(candidates);
  if (is_new) {
    std::vector<WeightedNode> nodes;
    for (const StateId state : candidates) {
      nodes.push_back({apartness_.node(state), likely.weight(state)});
    }
    keep_likeliest(nodes);
    found->second =
        find_adaptive_sequence(apartness_.tree(), std::move(nodes), largest_plan, &witnesses_);
  }
  return found->second;
}

// The access word and the input; nothing follows the last output yet.
DecisionTree LSharp::path_to(Transition transition) const {
  const ObservationTree& tree = apartness_.tree();
  DecisionTree path;
  Node node = ObservationTree::root;
  for (const Symbol input : apartness_.access(apartness_.source(transition))) {
    node = tree.child(node, input);
    const auto next = static_cast<std::uint32_t>(path.nodes.size() + 1);
    path.nodes.push_back({input, {{tree.output(node), next}}});
  }
  path.nodes.push_back({apartness_.input(transition), {}});
  return path;
}

// `word` is in the tree and the hypothesis is wrong about its last output. Ends when the transition
// from the basis to the frontier that some such word takes has lost its candidate.
//
// Invariant: access(states[low]) and the rest of the word from there ends in the true output (for
// the first place in the frontier: it is the word itself), access(states[high]) and its rest does
// not: at the end the output is that of a transition, which the hypothesis has right.
void LSharp::analyse(Word word, const RunControl& control) {
  const Symbol truth = last_output(word, control);
  std::size_t behind = 1;  // `high` from the end: the rest of the word is the same in all rounds
  while (true) {
    const std::vector<StateId> states = states_along(hypothesis(), word);
    std::size_t low = 0;
    Transition transition = 0;
    StateId state = 0;
    do {
      transition = static_cast<Transition>(state * apartness_.input_count() + word[low++]);
      state = apartness_.basis_target(transition);
    } while (state != Mealy::no_state && low < word.size());
    // States were found since the hypothesis was made, by a run that was interrupted.
    if (low == word.size()) return;
    const auto is_settled = [&] {
      const std::vector<StateId>& candidates = apartness_.candidates(transition);
      return candidates.size() != 1 || candidates.front() != states[low];
    };
    const auto from = [&](std::size_t place) {
      Word shortened = apartness_.access(states[place]);
      shortened.insert(shortened.end(), word.begin() + static_cast<std::ptrdiff_t>(place),
                       word.end());
      return shortened;
    };
    std::size_t high = std::max(low, word.size() - behind);
    Word shorter;
    while (shorter.empty()) {
      if (is_settled()) return;
      const std::size_t middle = low + (high - low) / 2;
      if (last_output(from(middle), control) == truth) {
        shorter = from(middle);
      } else {
        high = middle;
        behind = word.size() - high;
        MAIDE_CHECK(middle > low || is_settled());
      }
    }
    word = std::move(shorter);
  }
}

void LSharp::refine(const Word& counterexample, const RunControl& control) {
  Word outputs;
  if (!counterexample.empty()) last_output(counterexample, control);
  Node node = ObservationTree::root;
  for (const Symbol input : counterexample) {
    node = apartness_.tree().child(node, input);
    outputs.push_back(apartness_.tree().output(node));
  }
  const std::size_t length = first_mismatch(hypothesis(), counterexample, outputs);
  if (length == 0) {
    throw std::invalid_argument("the hypothesis agrees with the system on this word");
  }
  MAIDE_CHECK(length <= counterexample.size());
  const std::size_t states = hypothesis().size();
  analyse(head(counterexample, length), control);
  complete(control);
  MAIDE_CHECK(hypothesis().size() > states);  // every counterexample adds a state
}

void LSharp::check_invariants() const {
  apartness_.check_invariants();
  hypothesis_.check_invariants(apartness_);
}

// L# with a model of an earlier version: the words that come first, and the rules `rebuild` and
// `doubt`.

LSharp::LSharp(OutputOracle& oracle, const Mealy& old_model, Separation separation,
               const RunControl& control, std::span<const Word> first_words)
    : LSharp(oracle, separation) {
  matching_.emplace(OldModel(old_model, oracle.inputs(), control));
  first_words_.assign(first_words.rbegin(), first_words.rend());
}

// Few at once as long as little speaks for the old model.
void LSharp::verify(const RunControl& control) {
  constexpr std::size_t most_at_once = 64;
  const ObservationTree& tree = apartness_.tree();
  for (std::size_t at_once = 1; !first_words_.empty();
       at_once = std::min(2 * at_once, most_at_once)) {
    std::vector<Query> batch;
    while (!first_words_.empty() && batch.size() < at_once) {
      const Word word = std::move(first_words_.back());
      first_words_.pop_back();
      if (tree.find(ObservationTree::root, word) == ObservationTree::none) batch.emplace_back(word);
    }
    if (batch.empty()) return;
    ask(batch, control);
    if (!std::ranges::all_of(
            batch, [&](const Query& query) { return is_old_output(std::get<Word>(query)); })) {
      first_words_.clear();
    }
  }
}

// Of a word in the tree: whether all its outputs are those of the old model.
bool LSharp::is_old_output(const Word& word) const {
  const OldModel& old = matching_->old_model();
  StateId state = old.initial();
  Node node = ObservationTree::root;
  for (const Symbol input : word) {
    node = apartness_.tree().child(node, input);
    if (oracle_.outputs().name(apartness_.tree().output(node)) !=
        old.outputs().name(old.output(state, input))) {
      return false;
    }
    state = old.target(state, input);
  }
  return true;
}

// Asks for old states that no state of the basis is matched with, where the old model expects them;
// false if there are none.
bool LSharp::rebuild(const RunControl& control) {
  if (!matching_ || rebuilt_ == apartness_.size()) return false;
  matching_->update(apartness_, oracle_.outputs());
  std::vector<Query> batch;
  std::set<StateId> asked;  // old states
  for (Transition transition = 0; transition < apartness_.transition_count(); ++transition) {
    if (apartness_.target_node(transition) != ObservationTree::none) continue;
    const StateId expected = matching_->expected(apartness_, transition);
    if (expected == StateMatching::none) continue;
    if (matching_->matched_by(expected) != StateMatching::none) continue;
    if (!asked.insert(expected).second) continue;
    batch.emplace_back(
        joined(apartness_.word_to(transition), matching_->old_model().identifying_word(expected)));
    if (batch.size() == batch_size) break;
  }
  if (batch.empty()) {
    rebuilt_ = apartness_.size();
    return false;
  }
  ask(batch, control);
  return true;
}

// Every transition has one candidate. Asks one that should be another state, and its candidate,
// what told them apart in the old model; false if nothing is in doubt.
bool LSharp::doubt(const RunControl& control) {
  if (!matching_ || doubts_left_ <= 0) return false;
  matching_->update(apartness_, oracle_.outputs());
  const ObservationTree& tree = apartness_.tree();
  for (Transition transition = 0; transition < apartness_.transition_count(); ++transition) {
    if (apartness_.basis_target(transition) != Mealy::no_state) continue;
    const StateId expected = matching_->expected(apartness_, transition);
    if (expected == StateMatching::none) continue;
    if (matching_->matched_by(expected) != StateMatching::none) continue;
    const StateId candidate = apartness_.candidates(transition).front();
    if (matching_->match(candidate) == expected) continue;
    const Word suffix =
        matching_->old_model().separating_word(expected, matching_->match(candidate));
    std::vector<Query> batch;
    const Word here = joined(apartness_.word_to(transition), suffix);
    const Word there = joined(apartness_.access(candidate), suffix);
    const auto is_new = [&](const Word& word) {
      return tree.find(ObservationTree::root, word) == ObservationTree::none;
    };
    if (is_new(here)) batch.emplace_back(here);
    // What is asked here may begin with what is asked there.
    if (is_new(there) && !is_prefix(there, here)) batch.emplace_back(there);
    if (batch.empty()) continue;
    ask(batch, control);
    doubts_left_ += apartness_.has_isolated() ? 1 : -1;
    return true;
  }
  return false;
}

// A transition whose output is the old model's leads where that says, probably.
void LSharp::weigh_expected(Transition transition, Symbol output,
                            std::vector<double>& weights) const {
  if (!matching_ || !matching_->agrees(apartness_, transition, output)) return;
  const StateId expected = matching_->matched_by(matching_->expected(apartness_, transition));
  if (expected == StateMatching::none) return;
  weights[expected] += 4 * std::accumulate(weights.begin(), weights.end(), 0.0);
}

}  // namespace maide
