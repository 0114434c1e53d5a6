#include "check_systems.hpp"

#include <fmt/format.h>

#include "maide/base/file.hpp"

namespace maide::bench {
namespace {

// A queue as it is learned: it keeps every message, and was tried with at most `size`. States: k
// messages are held; a read waits; a message is due, and k are left.
ModelText queue(unsigned size, bool has_tryread) {
  std::string dot = fmt::format(
      "digraph g {{\n  inputs=\"write,read{}\";\n  outputs=\"message\";\n"
      "  bound=\"at most {} messages in flight\";\n  __start0 [label=\"\" shape=\"none\"];\n"
      "  __start0 -> h0;\n  h{} [unexplored=\"write\"];\n",
      has_tryread ? ",tryread" : "", size, size);
  const auto edge = [&](const std::string& from, const std::string& to, const char* label) {
    dot += fmt::format("  {} -> {} [label=\"{}\"];\n", from, to, label);
  };
  const auto held = [](unsigned k) { return "h" + std::to_string(k); };
  const auto due = [](unsigned k) { return "d" + std::to_string(k); };
  edge(held(0), "waiting", "?read");
  edge("waiting", due(0), "?write");
  if (has_tryread) edge(held(0), held(0), "?tryread");
  for (unsigned k = 0; k < size; ++k) {
    edge(held(k), held(k + 1), "?write");
    edge(held(k + 1), due(k), "?read");
    if (has_tryread) edge(held(k + 1), due(k), "?tryread");
    edge(due(k), held(k), "!message");
  }
  return {fmt::format("queue-{}{}.dot", size, has_tryread ? "-tryread" : ""), dot + "}\n"};
}

ModelText fork() {
  return {"fork.dot",
          "digraph g {\n  inputs=\"take,put\";\n  outputs=\"\";\n"
          "  __start0 [label=\"\" shape=\"none\"];\n  __start0 -> free;\n"
          "  free -> taken [label=\"?take\"];\n  taken -> free [label=\"?put\"];\n}\n"};
}

std::string instance(const std::string& name, const ModelText& model, const char* at_bound) {
  return fmt::format("  {}: {{file: {}, when_unexplored: {}}}\n", name, model.file, at_bound);
}

std::string response(const std::string& formula) {
  return fmt::format("properties:\n  response: {{ltl: \"{}\", fairness: none}}\n", formula);
}

}  // namespace

SystemText grasping(unsigned n) {
  const ModelText first = queue(6, true), second = queue(6, false);
  std::string yaml = "models:\n" + instance("q1", first, "drop") + instance("q2", second, "wait");
  yaml += fmt::format(
      "programs:\n  p1: \"repeat {} {{ q1.write; }}\"\n  p2: \"repeat {} {{ q2.write; }}\"\n"
      "  p3: \"repeat {} {{ switch q1.tryread {{ message {{}} quiet {{}} }} q2.read -> message; "
      "}}\"\n",
      n / 10 * 9, n, n);
  return {fmt::format("grasping-{}", n),
          yaml + response("F (p1@end && p2@end && p3@end)"),
          {first, second},
          ""};
}

SystemText philosophers(unsigned count) {
  const ModelText model = fork();
  std::string yaml = "models:\n", programs = "programs:\n";
  for (unsigned i = 0; i < count; ++i) {
    yaml += fmt::format("  fork{}: {{file: {}}}\n", i, model.file);
    const unsigned right = (i + 1) % count;
    const bool is_last = right == 0;
    programs += fmt::format(
        "  phil{0}: \"loop {{ @hungry fork{1}.take; @waiting fork{2}.take; @eating fork{1}.put; "
        "fork{2}.put; }}\"\n",
        i, is_last ? right : i, is_last ? i : right);
  }
  return {fmt::format("philosophers-{}", count),
          yaml + programs + response("G F phil0@eating && G F phil0@hungry -> G F phil0@waiting"),
          {model},
          ""};
}

SystemText pipeline(unsigned stages, unsigned size) {
  const ModelText model = queue(size, false), window = queue(2, false);
  std::string yaml = "models:\n" + instance("ack", window, "wait");
  for (unsigned i = 0; i < stages; ++i) yaml += instance(fmt::format("q{}", i), model, "wait");
  yaml += fmt::format(
      "programs:\n  camera: |\n    repeat {0} {{ q0.write; }}\n    loop {{\n      repeat {0} {{ "
      "@sends q0.write; }}\n      @waits ack.read -> message;\n    }}\n",
      size);
  for (unsigned i = 0; i + 1 < stages; ++i) {
    yaml += fmt::format("  stage{0}: \"loop {{ q{0}.read -> message; q{1}.write; }}\"\n", i, i + 1);
  }
  yaml +=
      fmt::format("  last: \"loop {{ repeat {} {{ q{}.read -> message; }} @done ack.write; }}\"\n",
                  size, stages - 1);
  return {fmt::format("pipeline-{}-{}", stages, size),
          yaml + response("G F camera@waits -> G F last@done"),
          stages > 0 && size != 2 ? std::vector{model, window} : std::vector{window}, ""};
}

SystemText token_ring(unsigned stations, unsigned size) {
  const ModelText mailbox = queue(1, false), sensor = queue(size, true);
  std::string yaml = "models:\n", programs = "programs:\n";
  for (unsigned i = 0; i < stations; ++i) {
    yaml += instance(fmt::format("box{}", i), mailbox, "wait");
    yaml += instance(fmt::format("sensor{}", i), sensor, "drop");
    programs += fmt::format(
        "  source{0}: \"loop {{ sensor{0}.write; }}\"\n"
        "  station{0}: |\n{1}    loop {{\n      box{0}.read -> message;\n"
        "      @holds switch sensor{0}.tryread {{ message {{}} quiet {{}} }}\n"
        "      @passes box{2}.write;\n    }}\n",
        i, i == 0 ? "    box1.write;\n" : "", (i + 1) % stations);
  }
  return {
      fmt::format("token-ring-{}-{}", stations, size),
      yaml + programs + response("G F station0@holds && G F station1@holds -> G F station0@passes"),
      {mailbox, sensor},
      ""};
}

SystemText robots(unsigned count) {
  const std::string yaml = fmt::format(
      "constants: {{n: {}}}\n"
      "models:\n"
      "  map: {{use: mutex}}\n"
      "  via[i in 0..n - 1]: {{use: queue, with: {{size: 2}}}}\n"
      "  reply[i in 0..n - 1]: {{use: queue, with: {{size: 1}}}}\n"
      "programs:\n"
      "  planner[i in 0..n - 1]: |\n"
      "    loop {{ map.lock; repeat 2 {{ via[i].write; }} map.unlock; reply[i].read -> message; "
      "}}\n"
      "  relay[i in 0..n - 1]: |\n"
      "    loop {{ repeat 2 {{ via[i].read -> message; }} map.lock; map.unlock; reply[i].write; "
      "}}\n",
      count);
  const std::string promela = fmt::format(
      "#define N {}\n"
      "chan via[N] = [2] of {{ bit }};\n"
      "chan reply[N] = [1] of {{ bit }};\n"
      "bool locked;\n"
      "active [N] proctype planner() {{\n"
      "  do\n"
      "  :: d_step {{ !locked -> locked = true }};\n"
      "     via[_pid]!0; via[_pid]!0; locked = false; reply[_pid]?_\n"
      "  od\n"
      "}}\n"
      "active [N] proctype relay() {{\n"
      "  do\n"
      "  :: via[_pid - N]?_; via[_pid - N]?_;\n"
      "     d_step {{ !locked -> locked = true }};\n"
      "     locked = false; reply[_pid - N]!0\n"
      "  od\n"
      "}}\n",
      count);
  return {fmt::format("robots-{}", count), yaml, {}, promela};
}

std::filesystem::path write_system(const SystemText& system, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const ModelText& model : system.models) {
    write_file_atomically(folder / model.file, model.dot);
  }
  std::filesystem::path file = folder / (system.name + ".yaml");
  write_file_atomically(file, system.yaml);
  return file;
}

}  // namespace maide::bench
