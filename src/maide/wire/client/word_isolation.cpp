// The half of WrapperProxy that finds out what a word does in which the wrapper died: it is asked
// alone, in fresh processes, until it is answered or the death is reproducible. To know at which
// step a process died, the wrapper is asked to announce each step that is over; one that cannot is
// asked the word's prefixes, one after the other. Costs two or three processes for each crash.
#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/sul/query_player.hpp"
#include "maide/wire/client/proxy_state.hpp"

namespace maide {
namespace {

using Clock = std::chrono::steady_clock;

// The answer that the death at hand is; of one that came after its first step.
SulAnswer to_answer(const SulQuery& query, const Death& death, const SulInfo& info) {
  SulAnswer answer;
  answer.end = death.end;
  answer.reason = death.reason;
  QueryCursor cursor(query);
  for (const SulStep& step : *death.before) {
    answer.inputs.push_back(*cursor.input());
    answer.steps.push_back(step);
    cursor.advance(step);
  }
  answer.inputs.push_back(*cursor.input());
  answer.steps.emplace_back();
  mark_fatal_step(answer, info);
  return answer;
}

std::optional<Symbol> input_after(const SulQuery& query, const std::vector<SulStep>& steps) {
  QueryCursor cursor(query);
  for (const SulStep& step : steps) cursor.advance(step);
  return cursor.input();
}

}  // namespace

void WrapperProxy::isolate(Batch& batch, const RunControl& control) {
  MAIDE_CHECK(batch.suspect.has_value());
  const std::size_t index = batch.suspect->index;
  const SulQuery& query = batch.queries[index];
  DeathRecord& record = batch.suspect->record;
  std::optional<SulAnswer> answer;
  while (!answer) {
    Outcome outcome;
    try {
      drop_connection();
      reconnect(control);
      outcome = announces_steps_ ? ask_announced(query, control) : ask_prefixes(query, control);
    } catch (...) {
      drop_connection();
      throw;
    }
    if (outcome.answer) {
      answer = std::move(outcome.answer);
      answer->attempts = record.count() + 1;
      for (const Death& death : record.deaths()) {
        incidents_.add({death.reason, batch.suspect->after, text_of(query)});
      }
      batch.last_answered = index;
      batch.answered_since_start = 1;
      continue;
    }
    drop_connection();
    const DeathRecord::Verdict verdict = record.add(std::move(outcome.death));
    if (verdict == DeathRecord::Verdict::ask_again) continue;
    if (verdict == DeathRecord::Verdict::hopeless || record.last().in_reset) {
      give_up(query, record);
    }
    MAIDE_CHECK(record.last().before.has_value());
    answer = to_answer(query, record.last(), info_);
    answer->attempts = record.count();
    fatal_words_.add(*answer, query.translation);
    fatal_words_.mark_asked(query);
  }
  batch.suspect.reset();
  batch.last_sign = Clock::now();
  deliver(batch, index, std::move(*answer));
}

void WrapperProxy::give_up(const SulQuery& query, const DeathRecord& record) const {
  const std::string& reason = record.last().reason;
  if (record.last().in_reset) {
    fail(fmt::format("{}; it did so {} times in the reset before the word \"{}\"", reason,
                     record.count(), text_of(query)));
  }
  fail(fmt::format("{}; it died {} times {}, at differing places", reason, record.count(),
                   describe(query)));
}

WrapperProxy::Outcome WrapperProxy::ask_announced(const SulQuery& query,
                                                  const RunControl& control) {
  Outcome outcome = ask_alone(query, true, control);
  const bool is_answered = outcome.answer || outcome.death.in_reset ||
                           input_after(query, *outcome.death.before).has_value();
  if (is_answered) return outcome;
  // It died behind the last step, which it had announced: the word is answered.
  outcome.answer.emplace();
  QueryCursor cursor(query);
  for (const SulStep& step : *outcome.death.before) {
    outcome.answer->inputs.push_back(*cursor.input());
    outcome.answer->steps.push_back(step);
    cursor.advance(step);
  }
  return outcome;
}

// A death counts only as that of the first prefix that a process is asked: it may be the end of the
// prefix before that did it.
WrapperProxy::Outcome WrapperProxy::ask_prefixes(const SulQuery& query, const RunControl& control) {
  SulQuery prefix = {Word(), query.translation};
  bool is_fresh = true;
  Outcome before;  // of the prefix that is one shorter
  while (true) {
    Outcome outcome = ask_alone(prefix, false, control);
    if (!outcome.answer) {
      if (outcome.death.before) return outcome;  // the wrapper said where
      if (!is_fresh) {
        drop_connection();
        reconnect(control);
        is_fresh = true;
        continue;
      }
      outcome.death.in_reset = !before.answer;
      outcome.death.before =
          before.answer ? std::move(before.answer->steps) : std::vector<SulStep>();
      return outcome;
    }
    const std::optional<Symbol> next = input_after(query, outcome.answer->steps);
    if (!next || outcome.answer->end != WordEnd::complete) return outcome;
    std::get<Word>(prefix.inputs).push_back(*next);
    before = std::move(outcome);
    is_fresh = false;
  }
}

// Asks one query of the process at hand, which has no other.
WrapperProxy::Outcome WrapperProxy::ask_alone(const SulQuery& query, bool announced,
                                              const RunControl& control) {
  MAIDE_CHECK(pending_.empty());  // it is asked alone
  const protocol::Run run{next_id_++, query, announced};
  connection_->send(protocol::encode(run, info_));
  pending_[run.id] = {run.query, 0, false};
  Outcome outcome;
  if (announced) {
    outcome.death.before.emplace();
    outcome.death.in_reset = true;
  }
  const auto limit = silence_limit(announced ? 0 : std::get<Word>(query.inputs).size());
  Clock::time_point last_sign = Clock::now();
  try {
    while (!outcome.is_over) {
      control.check("running words on the system");
      if (const auto line = connection_->receive(wire_piece)) {
        last_sign = Clock::now();
        outcome.is_over = take_line_alone(outcome, *line, run.id);
      } else if (Clock::now() - last_sign >= limit) {
        outcome.death.end = WordEnd::hang;
        outcome.death.reason = describe_silence(limit);
        outcome.is_over = true;
      }
    }
  } catch (const ConnectionLost& lost) {
    // A wrapper that said that it leaves has said why, too.
    if (outcome.death.reason.empty()) outcome.death.reason = lost.what();
  } catch (const protocol::ProtocolError& error) {
    fail(error.what());
  }
  pending_.clear();
  return outcome;
}

// True if the query is answered.
bool WrapperProxy::take_line_alone(Outcome& outcome, const std::string& line, std::uint64_t id) {
  protocol::FromWrapper message = protocol::decode_from_wrapper(line, Context(*this));
  if (auto* answer = std::get_if<protocol::Answer>(&message)) {
    if (!is_fatal(answer->answer.end)) {
      outcome.answer = std::move(answer->answer);
      return true;
    }
    answer->answer.steps.pop_back();
    outcome.death = {answer->answer.end, std::move(answer->answer.reason),
                     std::move(answer->answer.steps), false};
    return true;
  }
  if (std::holds_alternative<protocol::Ready>(message) && outcome.death.before) {
    outcome.death.in_reset = false;
  } else if (auto* step = std::get_if<protocol::Step>(&message); step && outcome.death.before) {
    const SulQuery& query = pending_.at(id).query;
    if (!input_after(query, *outcome.death.before)) {
      throw protocol::ProtocolError("the wrapper announced more steps than were asked");
    }
    outcome.death.in_reset = false;
    outcome.death.before->push_back(std::move(step->step));
  } else if (const auto* leaving = std::get_if<protocol::Leaving>(&message)) {
    if (!outcome.death.reason.empty()) throw protocol::ProtocolError("'leaving' came twice");
    outcome.death.reason = leaving->reason.empty() ? "the wrapper left" : leaving->reason;
  } else if (const auto* error = std::get_if<protocol::ErrorReport>(&message)) {
    report(*error, &pending_.at(id).query);
  } else {
    fail("the wrapper sent a line of a type that nobody asked for");
  }
  return false;
}

}  // namespace maide
