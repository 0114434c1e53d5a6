// The part of a plug-in for LTSmin that is the same for every system (pins_system.cpp).
#pragma once

#include <string_view>

namespace maide {

// The parts in their order. Between them stand tables.

inline constexpr std::string_view pins_declarations = R"(
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

// What LTSmin gives to its plug-ins, as far as this one uses it.
extern "C" {
struct grey_box_model;
struct lts_type_s;
struct matrix;
struct transition_info { int *labels; int group; int por_proviso; };
struct chunk { std::uint32_t len; char *data; };
struct list { int count; int item[1]; };  // as many items as it counts
using transition_callback = void (*)(void *, transition_info *, int *, int *);

void dm_create(matrix *, int rows, int columns);
void dm_set(matrix *, int row, int column);
lts_type_s *lts_type_create();
int lts_type_put_type(lts_type_s *, const char *name, int format, int *is_new);
void lts_type_set_state_length(lts_type_s *, int);
void lts_type_set_state_name(lts_type_s *, int, const char *);
void lts_type_set_state_typeno(lts_type_s *, int, int type);
void lts_type_set_edge_label_count(lts_type_s *, int);
void lts_type_set_edge_label_name(lts_type_s *, int, const char *);
void lts_type_set_edge_label_typeno(lts_type_s *, int, int type);
void lts_type_set_state_label_count(lts_type_s *, int);
void lts_type_set_state_label_name(lts_type_s *, int, const char *);
void lts_type_set_state_label_typeno(lts_type_s *, int, int type);
void lts_type_validate(lts_type_s *);
void pins_chunk_put_at(grey_box_model *, int type, chunk, int index);
void GBsetLTStype(grey_box_model *, lts_type_s *);
void GBsetInitialState(grey_box_model *, int *);
void GBsetNextStateLong(grey_box_model *, int (*)(grey_box_model *, int group, int *,
                                                  transition_callback, void *));
void GBsetNextStateAll(grey_box_model *, int (*)(grey_box_model *, int *, transition_callback,
                                                 void *));
void GBsetStateLabelLong(grey_box_model *, int (*)(grey_box_model *, int label, int *));
void GBsetStateLabelsAll(grey_box_model *, void (*)(grey_box_model *, int *, int *));
void GBsetStateLabelsGroup(grey_box_model *, void (*)(grey_box_model *, int, int *, int *));
void GBsetStateLabelGroupInfo(grey_box_model *, int, list *);
void GBsetStateLabelInfo(grey_box_model *, matrix *);
void GBsetDMInfo(grey_box_model *, matrix *);
void GBsetDMInfoRead(grey_box_model *, matrix *);
void GBsetDMInfoMayWrite(grey_box_model *, matrix *);
void GBsetDMInfoMustWrite(grey_box_model *, matrix *);
void GBsetGuardsInfo(grey_box_model *, list **);
void GBsetGuardNESInfo(grey_box_model *, matrix *);
void GBsetGuardNDSInfo(grey_box_model *, matrix *);
void GBsetGuardCoEnabledInfo(grey_box_model *, matrix *);
void GBsetDoNotAccordInfo(grey_box_model *, matrix *);
void GBsetGroupsOfEdge(grey_box_model *, int (*)(grey_box_model *, int edge, int value, int *));
void pins_model_init(grey_box_model *);
}

namespace {

// A group of transitions: what one program does, from whatever place of it. The relations are those
// of the models that take part.
struct group_row { int program, first_relation, last_relation, action; bool is_cut, is_error, is_death; };
// What a model may do: from state s to next_state[first_move[first + s]] and those that follow,
// before next_state[first_move[first + s + 1]].
struct relation_row { int slot, first, states; };
// A program may go from one of its places to another by a transition of the group.
struct rule_row { int group, target; };
)";

inline constexpr std::string_view pins_steps = R"(
// ---- Steps ----

struct moves { const int *begin, *end; };

moves moves_of(int relation, int state) {
  const int *first = first_move + relations[relation].first + state;
  return {next_state + first[0], next_state + first[1]};
}
bool is_enabled(const group_row &group, const int *state) {
  for (int i = group.first_relation; i < group.last_relation; ++i) {
    const moves found = moves_of(part[i], state[relations[part[i]].slot]);
    if (found.begin == found.end) return false;
  }
  return true;
}
bool is_halted(const int *state) { return halted >= 0 && state[halted] != 0; }
const rule_row *rules_at(int place) { return rules + first_rule[place]; }
int place_of(int program, const int *state) { return first_place[program] + state[program]; }

// A transition for each choice of moves. A cut stays where it is.
int take(const rule_row &rule, const int *state, transition_callback report, void *context) {
  const group_row &group = groups[rule.group];
  if (!is_enabled(group, state)) return 0;
  const int *chosen[most_parts] = {};
  int next[slots], label = group.action, count = 0;
  const int parts = group.last_relation - group.first_relation;
  const auto found = [&](int i) {
    const int relation = part[group.first_relation + i];
    return moves_of(relation, state[relations[relation].slot]);
  };
  for (int i = 0; i < parts; ++i) chosen[i] = found(i).begin;
  while (true) {
    std::memcpy(next, state, sizeof next);
    if (!group.is_cut) {
      for (int i = 0; i < parts; ++i) {
        next[relations[part[group.first_relation + i]].slot] = *chosen[i];
      }
      next[group.program] = rule.target;
      if constexpr (halted >= 0) next[halted] = group.is_error;
    }
    transition_info transition = {&label, rule.group, 0};
    report(context, &transition, next, nullptr);
    ++count;
    int i = parts;
    while (--i >= 0 && ++chosen[i] == found(i).end) chosen[i] = found(i).begin;
    if (i < 0) return count;
  }
}

int next_of_group(grey_box_model *, int group, int *state, transition_callback report, void *context) {
  if (is_halted(state)) return 0;
  const int place = place_of(groups[group].program, state);
  int count = 0;
  for (const rule_row *rule = rules_at(place); rule != rules_at(place + 1); ++rule) {
    if (rule->group == group) count += take(*rule, state, report, context);
  }
  return count;
}

int next_of_all(grey_box_model *, int *state, transition_callback report, void *context) {
  if (is_halted(state)) return 0;
  int count = 0;
  for (int program = 0; program < programs; ++program) {
    const int place = place_of(program, state);
    for (const rule_row *rule = rules_at(place); rule != rules_at(place + 1); ++rule) {
      count += take(*rule, state, report, context);
    }
  }
  return count;
}

// ---- Labels of states: a guard for each group's places, one for each relation, and `halted` ----

constexpr int guards = group_count + relation_count + (halted >= 0 ? 1 : 0);

bool has_group(int place, int group) {
  for (const rule_row *rule = rules_at(place); rule != rules_at(place + 1); ++rule) {
    if (rule->group == group) return true;
  }
  return false;
}

// Some group can take a step that is `of_kind`.
template <typename Kind>
bool can(const int *state, Kind of_kind) {
  if (is_halted(state)) return false;
  for (int program = 0; program < programs; ++program) {
    const int place = place_of(program, state);
    for (const rule_row *rule = rules_at(place); rule != rules_at(place + 1); ++rule) {
      const group_row &group = groups[rule->group];
      if (of_kind(group) && is_enabled(group, state)) return true;
    }
  }
  return false;
}
bool all_may_stay(const int *state) {
  for (int program = 0; program < programs; ++program) {
    if (!may_stay[place_of(program, state)]) return false;
  }
  return true;
}
int valid_end(const int *state) { return is_halted(state) || all_may_stay(state); }
int deadlock(const int *state) {
  return !valid_end(state) && !can(state, [](const group_row &group) { return !group.is_death; });
}
int error(const int *state) { return is_halted(state); }
int beyond(const int *state) {
  return can(state, [](const group_row &group) { return group.is_cut; });
}

// An atom of a formula is a table of truth values, by what it sees in some slots.
struct seen_row { int slot, first_class, classes; };
struct atom_row { int first_seen, last_seen, first_value; };
)";

inline constexpr std::string_view pins_atoms = R"(
[[maybe_unused]] bool is_true(int atom, const int *state) {
  int place = 0;
  for (int i = atoms[atom].first_seen; i < atoms[atom].last_seen; ++i) {
    place = place * seen[i].classes + seen_class[seen[i].first_class + state[seen[i].slot]];
  }
  return atom_value[atoms[atom].first_value + place] != 0;
}
struct further_row { const char *name; int (*value)(const int *); };
)";

inline constexpr std::string_view pins_labels = R"(
int label_of(grey_box_model *, int label, int *state) {
  if (label < group_count) return has_group(place_of(groups[label].program, state), label);
  if (label < group_count + relation_count) {
    const int relation = label - group_count;
    const moves found = moves_of(relation, state[relations[relation].slot]);
    return found.begin != found.end;
  }
  return label < guards ? !is_halted(state) : further[label - guards].value(state);
}
void labels_of_kind(grey_box_model *, int kind, int *state, int *values) {
  const int count = kind == 1 ? guards : guards + further_count;
  for (int label = 0; label < count; ++label) values[label] = label_of(nullptr, label, state);
}
void all_labels(grey_box_model *, int *state, int *values) {
  labels_of_kind(nullptr, 0, state, values);
}
int groups_of_action(grey_box_model *, int, int action, int *found) {
  int count = 0;
  for (int group = 0; group < group_count; ++group) {
    if (groups[group].action != action) continue;
    if (found != nullptr) found[count] = group;
    ++count;
  }
  return count;
}

// ---- What depends on what ----

matrix *new_matrix(int rows, int columns) {
  auto *made = static_cast<matrix *>(std::calloc(1, 1024));  // LTSmin's has some 120 bytes
  dm_create(made, rows, columns);
  return made;
}
list *new_list(const std::vector<int> &items) {
  auto *made = static_cast<list *>(std::malloc(sizeof(int) * (items.size() + 2)));
  made->count = static_cast<int>(items.size());
  for (int i = 0; i < made->count; ++i) made->item[i] = items[i];
  return made;
}
bool changes(int relation) {
  for (int state = 0; state < relations[relation].states; ++state) {
    const moves found = moves_of(relation, state);
    for (const int *to = found.begin; to != found.end; ++to) {
      if (*to != state) return true;
    }
  }
  return false;
}

// How two relations of one model go together, where each belongs to another program.
enum class together { never, accord, not_accord };

// The states after both, or nothing if one takes the other away. A cut changes nothing.
bool both(int one, bool one_stays, int other, bool other_stays, int state, std::vector<bool> &after) {
  after.assign(relations[one].states, false);
  const moves first = moves_of(one, state);
  for (const int *to = first.begin; to != first.end; ++to) {
    const int between = one_stays ? state : *to;
    const moves second = moves_of(other, between);
    if (second.begin == second.end) return false;
    for (const int *end = second.begin; end != second.end; ++end) {
      after[other_stays ? between : *end] = true;
    }
  }
  return true;
}
constexpr int most_states_compared = 1024;
together compare(int one, bool one_stays, int other, bool other_stays) {
  if (one_stays && other_stays) return together::accord;
  if (relations[one].states > most_states_compared) return together::not_accord;
  bool meet = false;
  std::vector<bool> after, reversed;
  for (int state = 0; state < relations[one].states; ++state) {
    const moves first = moves_of(one, state), second = moves_of(other, state);
    if (first.begin == first.end || second.begin == second.end) continue;
    meet = true;
    if (!both(one, one_stays, other, other_stays, state, after) ||
        !both(other, other_stays, one, one_stays, state, reversed) || after != reversed) {
      return together::not_accord;
    }
  }
  return meet ? together::accord : together::never;
}

void set_dependencies(grey_box_model *model) {
  matrix *all = new_matrix(group_count, slots), *read = new_matrix(group_count, slots);
  matrix *may_write = new_matrix(group_count, slots), *must_write = new_matrix(group_count, slots);
  std::vector<bool> is_moving(group_count);
  for (int place = 0; place < first_place[programs]; ++place) {
    for (const rule_row *rule = rules_at(place); rule != rules_at(place + 1); ++rule) {
      const group_row &group = groups[rule->group];
      if (!group.is_cut && first_place[group.program] + rule->target != place) {
        is_moving[rule->group] = true;
      }
    }
  }
  auto **guards_of = static_cast<list **>(std::malloc(sizeof(list *) * (group_count + 1)));
  for (int number = 0; number < group_count; ++number) {
    const group_row &group = groups[number];
    std::vector<int> reads{group.program}, writes, guard{number};
    if (is_moving[number]) writes.push_back(group.program);
    for (int i = group.first_relation; i < group.last_relation; ++i) {
      reads.push_back(relations[part[i]].slot);
      if (!group.is_cut && changes(part[i])) writes.push_back(relations[part[i]].slot);
      guard.push_back(group_count + part[i]);
    }
    if (halted >= 0) {
      reads.push_back(halted);
      if (group.is_error) writes.push_back(halted);
      guard.push_back(guards - 1);
    }
    for (const int slot : reads) {
      dm_set(all, number, slot);
      dm_set(read, number, slot);
    }
    for (const int slot : writes) {
      dm_set(all, number, slot);
      dm_set(may_write, number, slot);
      dm_set(must_write, number, slot);
    }
    guards_of[number] = new_list(guard);
  }
  GBsetDMInfo(model, all);
  GBsetDMInfoRead(model, read);
  GBsetDMInfoMayWrite(model, may_write);
  GBsetDMInfoMustWrite(model, must_write);
  GBsetGuardsInfo(model, guards_of);

  matrix *seen = new_matrix(guards + further_count, slots);
  for (int group = 0; group < group_count; ++group) dm_set(seen, group, groups[group].program);
  for (int i = 0; i < relation_count; ++i) dm_set(seen, group_count + i, relations[i].slot);
  if (halted >= 0) dm_set(seen, guards - 1, halted);
  for (int i = 0; i < further_count; ++i) {
    for (int slot = 0; slot < slots; ++slot) {
      if (sees[i * slots + slot]) dm_set(seen, guards + i, slot);
    }
  }
  GBsetStateLabelInfo(model, seen);
}

// Guards of a program's places, which of its groups make them true or false, and which two can be
// true together.
void relate_places(matrix *enables, matrix *disables, matrix *coexist) {
  for (int one = 0; one < group_count; ++one) {
    for (int other = 0; other < group_count; ++other) {
      if (groups[one].program != groups[other].program) dm_set(coexist, one, other);
    }
  }
  for (int program = 0; program < programs; ++program) {
    for (int place = first_place[program]; place < first_place[program + 1]; ++place) {
      for (const rule_row *rule = rules_at(place); rule != rules_at(place + 1); ++rule) {
        for (const rule_row *here = rules_at(place); here != rules_at(place + 1); ++here) {
          dm_set(coexist, rule->group, here->group);
        }
        if (groups[rule->group].is_cut) continue;
        const int target = first_place[program] + rule->target;
        for (const rule_row *then = rules_at(target); then != rules_at(target + 1); ++then) {
          if (!has_group(place, then->group)) dm_set(enables, then->group, rule->group);
        }
        for (const rule_row *here = rules_at(place); here != rules_at(place + 1); ++here) {
          if (!has_group(target, here->group)) dm_set(disables, here->group, rule->group);
        }
      }
    }
  }
}

// The same of relations: `by` is one of the group's.
void relate_models(int guard, int by, int group, matrix *enables, matrix *disables) {
  if (groups[group].is_cut || relations[guard].slot != relations[by].slot) return;
  for (int state = 0; state < relations[by].states; ++state) {
    const moves here = moves_of(guard, state), found = moves_of(by, state);
    for (const int *to = found.begin; to != found.end; ++to) {
      const moves then = moves_of(guard, *to);
      const bool before = here.begin != here.end, after = then.begin != then.end;
      if (!before && after) dm_set(enables, group_count + guard, group);
      if (before && !after) dm_set(disables, group_count + guard, group);
    }
  }
}

bool may_meet(int one, int other) {
  if (relations[one].slot != relations[other].slot) return true;
  if (relations[one].states > most_states_compared) return true;
  for (int state = 0; state < relations[one].states; ++state) {
    const moves first = moves_of(one, state), second = moves_of(other, state);
    if (first.begin != first.end && second.begin != second.end) return true;
  }
  return false;
}

bool accords(const group_row &one, const group_row &other, bool places_meet,
             std::vector<signed char> &known) {
  if (!places_meet) return true;
  if (one.program == other.program || one.is_error || other.is_error) return false;
  bool all_accord = true;
  for (int i = one.first_relation; i < one.last_relation; ++i) {
    for (int j = other.first_relation; j < other.last_relation; ++j) {
      if (relations[part[i]].slot != relations[part[j]].slot) continue;
      signed char &answer = known[((part[i] * 2 + one.is_cut) * relation_count + part[j]) * 2 + other.is_cut];
      if (answer < 0) {
        answer = static_cast<signed char>(compare(part[i], one.is_cut, part[j], other.is_cut));
      }
      if (answer == static_cast<signed char>(together::never)) return true;
      if (answer == static_cast<signed char>(together::not_accord)) all_accord = false;
    }
  }
  return all_accord;
}

void set_reduction(grey_box_model *model) {
  const int labels = guards + further_count;
  matrix *enables = new_matrix(labels, group_count), *disables = new_matrix(labels, group_count);
  matrix *coexist = new_matrix(labels, labels);
  relate_places(enables, disables, coexist);
  for (int group = 0; group < group_count; ++group) {
    for (int i = groups[group].first_relation; i < groups[group].last_relation; ++i) {
      for (int guard = 0; guard < relation_count; ++guard) {
        relate_models(guard, part[i], group, enables, disables);
      }
    }
    if (groups[group].is_error) dm_set(disables, guards - 1, group);
    for (int i = 0; i < further_count; ++i) {
      dm_set(enables, guards + i, group);
      dm_set(disables, guards + i, group);
    }
  }
  for (int one = 0; one < labels; ++one) {
    for (int other = one < group_count ? group_count : 0; other < labels; ++other) {
      const bool are_relations = one >= group_count && other >= group_count &&
                                 one < group_count + relation_count &&
                                 other < group_count + relation_count;
      if (!are_relations || may_meet(one - group_count, other - group_count)) {
        dm_set(coexist, one, other);
      }
    }
  }
  GBsetGuardNESInfo(model, enables);
  GBsetGuardNDSInfo(model, disables);
  GBsetGuardCoEnabledInfo(model, coexist);

  matrix *against = new_matrix(group_count, group_count);
  std::vector<bool> meet(static_cast<std::size_t>(group_count) * group_count);
  for (int place = 0; place < first_place[programs]; ++place) {
    for (const rule_row *one = rules_at(place); one != rules_at(place + 1); ++one) {
      for (const rule_row *other = rules_at(place); other != rules_at(place + 1); ++other) {
        meet[static_cast<std::size_t>(one->group) * group_count + other->group] = true;
      }
    }
  }
  std::vector<signed char> known(static_cast<std::size_t>(relation_count) * relation_count * 4, -1);
  for (int one = 0; one < group_count; ++one) {
    for (int other = 0; other < group_count; ++other) {
      const bool places_meet = groups[one].program != groups[other].program ||
                               meet[static_cast<std::size_t>(one) * group_count + other];
      if (!accords(groups[one], groups[other], places_meet, known)) dm_set(against, one, other);
    }
  }
  GBsetDoNotAccordInfo(model, against);
}

void set_types(grey_box_model *model) {
  constexpr int direct = 0, enumeration = 3, boolean = 4, trilean = 5;
  lts_type_s *type = lts_type_create();
  int is_new = 0;
  const int number = lts_type_put_type(type, "state", direct, &is_new);
  const int action = lts_type_put_type(type, "action", enumeration, &is_new);
  const int guard = lts_type_put_type(type, "guard", trilean, &is_new);
  const int truth = lts_type_put_type(type, "bool", boolean, &is_new);
  lts_type_set_state_length(type, slots);
  for (int slot = 0; slot < slots; ++slot) {
    lts_type_set_state_name(type, slot, slot_names[slot]);
    lts_type_set_state_typeno(type, slot, number);
  }
  lts_type_set_edge_label_count(type, 1);
  lts_type_set_edge_label_name(type, 0, "action");
  lts_type_set_edge_label_typeno(type, 0, action);
  lts_type_set_state_label_count(type, guards + further_count);
  std::vector<int> numbers;
  for (int label = 0; label < guards + further_count; ++label) {
    char name[32] = "guard_";
    if (label < guards) {
      char digits[16];
      int length = 0;
      for (int rest = label; length == 0 || rest > 0; rest /= 10) {
        digits[length++] = static_cast<char>('0' + rest % 10);
      }
      for (int i = 0; i < length; ++i) name[6 + i] = digits[length - 1 - i];
    }
    lts_type_set_state_label_name(type, label, label < guards ? name : further[label - guards].name);
    lts_type_set_state_label_typeno(type, label, label < guards ? guard : truth);
    numbers.push_back(label);
  }
  lts_type_validate(type);
  GBsetLTStype(model, type);
  for (int i = 0; i < action_count; ++i) {
    const auto length = static_cast<std::uint32_t>(std::strlen(action_names[i]));
    pins_chunk_put_at(model, action, {length, const_cast<char *>(action_names[i])}, i);
  }
  GBsetStateLabelGroupInfo(model, 0, new_list(numbers));
  numbers.resize(guards);
  GBsetStateLabelGroupInfo(model, 1, new_list(numbers));
}

}  // namespace

extern "C" {

char pins_plugin_name[] = "maide";

void pins_model_init(grey_box_model *model) {
  set_types(model);
  int first[slots];
  std::memcpy(first, initial, sizeof first);
  GBsetInitialState(model, first);
  GBsetNextStateLong(model, next_of_group);
  GBsetNextStateAll(model, next_of_all);
  GBsetStateLabelLong(model, label_of);
  GBsetStateLabelsAll(model, all_labels);
  GBsetStateLabelsGroup(model, labels_of_kind);
  GBsetGroupsOfEdge(model, groups_of_action);
  set_dependencies(model);
  set_reduction(model);
}

}  // extern "C"
)";

}  // namespace maide
