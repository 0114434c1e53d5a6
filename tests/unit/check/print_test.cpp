// The style of system files, and that a layout changes nothing but blanks.
#include "maide/check/tree/print.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>

#include "maide/base/file.hpp"
#include "maide/check/tree/edit.hpp"
#include "systems.hpp"

namespace maide {
namespace {

namespace fs = std::filesystem;

std::string laid_out(const std::string& text) {
  const std::string once = format_system(text, "s.yaml");
  EXPECT_EQ(format_system(once, "s.yaml"), once);
  return once;
}

// Of a program in a block scalar.
std::string program(const std::string& text) {
  const std::string head = "programs:\n  p: |\n";
  std::string indented;
  for (const char c : text) indented += c == '\n' ? "\n    " : std::string(1, c);
  const std::string result = laid_out(head + "    " + indented + "\n");
  EXPECT_TRUE(result.starts_with(head)) << result;
  std::string lines;
  for (std::size_t at = head.size(); at < result.size(); at = result.find('\n', at) + 1) {
    const std::string line = result.substr(at, result.find('\n', at) - at);
    lines += (line.empty() ? line : line.substr(4)) + "\n";
  }
  return lines;
}

TEST(Layout, ProgramsHaveOneStyle) {
  EXPECT_EQ(program("loop{repeat 6{via.write;}\n@sent   sync.read->message ;}"),
            "loop {\n  repeat 6 { via.write; }\n  @sent sync.read -> message;\n}\n");
  EXPECT_EQ(program("if(n<2&&! ok){a.b;}else if * {c.d;} else{e.f;}"),
            "if (n < 2 && !ok) { a.b; } else if * { c.d; } else { e.f; }\n");
  EXPECT_EQ(program("if (ok) { a.b; } else {\ne.f; }"), "if (ok) {\n  a.b;\n} else {\n  e.f;\n}\n");
  EXPECT_EQ(program("var x:0..3=- 1;var m : { slow ,fast } ;\n\n\nvar a [ k in 0 .. 1 ] : bool;"),
            "var x: 0..3 = -1; var m: {slow, fast};\n\nvar a[k in 0..1]: bool;\n");
  EXPECT_EQ(program("x=a[ i+1 ]-1; x=any fair 0..n-1; m.write( x,new )->done(var y);"),
            "x = a[i + 1] - 1; x = any fair 0..n - 1; m.write(x, new) -> done(var y);\n");
  EXPECT_EQ(program("select{when(! p)on a.b->c{skip;}\non m ! out{ }\ntimeout 100{ @x skip; }}"),
            "select {\n  when (!p) on a.b -> c { skip; }\n  on m!out { }\n"
            "  timeout 100 { @x skip; }\n}\n");
  EXPECT_EQ(program("\"odd name\" . \"in put\";call p( a , b[1] );"),
            "\"odd name\".\"in put\"; call p(a, b[1]);\n");
}

TEST(Layout, AWordBehindADotIsAName) {
  EXPECT_EQ(program("q.wait (3); q.read->when(4);\nwhile(n<3){skip;}"),
            "q.wait(3); q.read -> when(4);\nwhile (n < 3) { skip; }\n");
}

TEST(Layout, CommentsStayWhereTheyBelong) {
  EXPECT_EQ(program("# first\nloop { // for ever\n  a.b;   # one\n  long.name;   # two\n}  # end"),
            "# first\nloop {  // for ever\n  a.b;        # one\n  long.name;  # two\n}  # end\n");
  EXPECT_EQ(program("if (x) # why\n{ a.b; }"), "# why\nif (x) { a.b; }\n");
}

TEST(Layout, WhatDoesNotFitIsBroken) {
  const std::string statement = "connection.write_something_long; ";
  EXPECT_EQ(program("loop { " + statement + statement + statement + "}"),
            "loop {\n  connection.write_something_long;\n  connection.write_something_long;\n"
            "  connection.write_something_long;\n}\n");
}

TEST(Layout, FilesHaveOneStyle) {
  EXPECT_EQ(laid_out("# head\n"
                     "models:   # what there is\n"
                     "    via:   {file:  x.dot,when_unexplored: wait}\n"
                     "    # below\n"
                     "    q : {use: queue,\n         with: {size: 2}}   # a queue\n"
                     "\n\n"
                     "programs:\n"
                     "  p:   loop{via.write;}\n"
                     "  r: { do: 'loop{via.write;}', may_die:   true }\n"
                     "  s: >\n      loop{via.write;}\n"
                     "properties:\n"
                     "  safe: G(p@end->F r@end)\n"
                     "  all: {always: \"n<2\"}\n"
                     "  hard: { ltl: 'G !\"odd name\"!gap',\n     fairness: none }\n"),
            "# head\n"
            "models:  # what there is\n"
            "  via: {file: x.dot, when_unexplored: wait}\n"
            "  # below\n"
            "  q: {use: queue, with: {size: 2}}  # a queue\n"
            "\n"
            "programs:\n"
            "  p: \"loop { via.write; }\"\n"
            "  r: {do: \"loop { via.write; }\", may_die: true}\n"
            "  s: |\n    loop { via.write; }\n"
            "properties:\n"
            "  safe: \"G(p@end -> F r@end)\"\n"
            "  all: {always: \"n < 2\"}\n"
            "  hard: {ltl: 'G !\"odd name\"!gap', fairness: none}\n");
}

// A map that is too long gets a line a key, and its program a block.
TEST(Layout, LongEntriesGetLinesOfTheirOwn) {
  const std::string statements = "queue.write; queue.write; queue.write; queue.write; ";
  EXPECT_EQ(laid_out("programs: {node: {may_die: true, do: \"loop { " + statements + statements +
                     "}\"}}\n"),
            "programs:\n  node:\n    may_die: true\n    do: |\n      loop {\n"
            "        queue.write;\n        queue.write;\n        queue.write;\n"
            "        queue.write;\n        queue.write;\n        queue.write;\n"
            "        queue.write;\n        queue.write;\n      }\n");
}

TEST(Layout, WhatIsNotKnownStaysAsItStands) {
  const std::string lists =
      "topics:\n  t:\n     readers:\n     -   a\n     - b\nprograms:\n  p: x.y;\n";
  EXPECT_THAT(laid_out(lists), testing::HasSubstr("    -   a\n    - b\n"));
  const std::string anchor = "models:\n   a: &x {use: mutex}\n   b:   *x\nprograms: {p: a.lock;}\n";
  EXPECT_THAT(laid_out(anchor), testing::HasSubstr("  a: &x {use: mutex}\n"));
}

// What stands in no form of this style, and is changed, is written in it; what is not, as it was.
TEST(Layout, ChangesAreWrittenWhereverTheyAreMade) {
  const auto printed = [](const std::string& text, const std::function<void(YamlNode&)>& change) {
    YamlDocument document = read_yaml(text, "x.yaml", "a system file");
    change(document.root);
    const std::string after = print_system(document);
    EXPECT_TRUE(is_same_value(read_yaml(after, "x.yaml", "a system file").root, document.root))
        << after;
    return after;
  };
  const auto set_size = [](YamlNode& root) {
    root.at("models").at("a").at("with").set("size", YamlNode("3"));
  };
  const std::string dashed =
      "models:\n  a:\n    with: {size: 2}\n    readers:\n      - p\n      - q\n"
      "  b:\n    readers:\n      - p  # first\n      - q\n";
  EXPECT_EQ(printed(dashed, [](YamlNode&) {}), dashed);
  EXPECT_EQ(printed(dashed, set_size),
            "models:\n  a:\n    with: {size: 3}\n    readers:\n      - p\n      - q\n"
            "  b:\n    readers:\n      - p  # first\n      - q\n");
  EXPECT_EQ(
      printed(dashed,
              [](YamlNode& root) { root.at("models").at("a").at("readers").entries.pop_back(); }),
      "models:\n  a:\n    with: {size: 2}\n    readers: [p]\n"
      "  b:\n    readers:\n      - p  # first\n      - q\n");
  // An anchor is written out wherever it stands.
  EXPECT_EQ(printed("models:\n  a: {use: queue, with: &w {size: 2, \"x\": \"y\"}}\n"
                    "  b: {use: queue, with: *w}\n",
                    set_size),
            "models:\n  a: {use: queue, with: {size: 3, \"x\": \"y\"}}\n"
            "  b: {use: queue, with: {size: 2, \"x\": \"y\"}}\n");
  EXPECT_EQ(printed("{models: {a: {with: {size: 2}}}}\n", set_size),
            "models: {a: {with: {size: 3}}}\n");
  EXPECT_EQ(printed("models:\n  a: {with: {size: 2, # two\n    depth: 4}}\n",
                    [](YamlNode& root) { root.at("models").at("a").at("with").remove("depth"); }),
            "models:\n  a: {with: {size: 2}}\n");
}

TEST(Edit, AValueBehindAnAnchorIsChangedAlone) {
  const YamlDocument document =
      read_yaml("constants: {x: &n 1, y: *n, z: 4}\n", "x.yaml", "a system file");
  const YamlNode& constants = *document.root.find("constants");
  EXPECT_EQ(with_value(document, *constants.find("x"), "2"), "constants: {x: 2, y: 1, z: 4}\n");
  EXPECT_EQ(with_value(document, *constants.find("y"), "2"), "constants: {x: 1, y: 2, z: 4}\n");
  const YamlDocument plain = read_yaml("constants: {x: 1,   y: 4}\n", "x.yaml", "a system file");
  EXPECT_EQ(with_value(plain, *plain.root.find("constants")->find("x"), "20"),
            "constants: {x: 20,   y: 4}\n");
}

TEST(Layout, WhatYamlTakesAsAnEscapeAloneStaysOne) {
  // A name in quotes, in a program on one line, in a long one, and in a formula.
  EXPECT_EQ(laid_out("programs: \n  p: \"loop{q.\\\"lo\\x01ck\\\";}\"\n"),
            "programs:\n  p: \"loop { q.\\\"lo\\x01ck\\\"; }\"\n");
  const std::string lines = "programs:\n  p: \"loop { q.\\\"lo\\x7fck\\\"; // why\\n }\"\n";
  EXPECT_EQ(laid_out(lines), lines);
  const std::string formula = "properties: {x: \"F p@\\\"\\u2028\\u0085\\x1b\\\"\"}\n";
  EXPECT_EQ(laid_out("programs: {p: \"skip;\"}\n" + formula),
            "programs: {p: \"skip;\"}\n" + formula);
  // A text that was made.
  YamlDocument made = read_yaml("programs: {p: skip}\n", "s.yaml", "a system file");
  made.root.set("properties", YamlNode("a\x01\u0085\u2029\uFEFF'\"b"));
  EXPECT_EQ(print_system(made),
            "programs: {p: skip}\nproperties: \"a\\x01\\u0085\\u2029\\ufeff'\\\"b\"\n");
}

TEST(Layout, ErrorsNameThePlace) {
  const auto error = [](const std::string& text) {
    return test::error_of([&] { format_system(text, "s.yaml"); });
  };
  EXPECT_EQ(error("programs:\n  p: |\n    loop { a.b;\n"), "this '{' is not closed (s.yaml:3:10)");
  EXPECT_EQ(error("programs: {p: \"a.b; }\"}\n"), "this '}' closes nothing (s.yaml:1:21)");
  EXPECT_THAT(error("programs: [\n"), testing::HasSubstr("not YAML"));
  EXPECT_THAT(error("- 1\n"), testing::HasSubstr("must be a map"));
  EXPECT_THAT(error(""), testing::HasSubstr("empty"));
}

// What the steps are, not where they stand.
bool is_same(const System& one, const System& other) {
  if (one.programs.size() != other.programs.size()) return false;
  for (std::size_t p = 0; p < one.programs.size(); ++p) {
    const Program &a = one.programs[p], &b = other.programs[p];
    if (a.name != b.name || a.states.size() != b.states.size() || a.labels != b.labels ||
        a.edges.size() != b.edges.size()) {
      return false;
    }
    for (std::size_t e = 0; e < a.edges.size(); ++e) {
      if (a.edges[e].kind != b.edges[e].kind || a.edges[e].model != b.edges[e].model ||
          a.edges[e].index != b.edges[e].index || a.edges[e].target != b.edges[e].target) {
        return false;
      }
    }
  }
  return one.properties.size() == other.properties.size();
}

// Those whose models lie beside them are parsed, too.
TEST(Layout, EveryExampleMeansTheSame) {
  std::size_t files = 0, parsed = 0;
  for (const auto& entry : fs::recursive_directory_iterator(MAIDE_SOURCE_DIR "/examples")) {
    if (entry.path().extension() != ".yaml") continue;
    ++files;
    const std::string text = read_file(entry.path());
    const std::string file = entry.path().string();
    const std::string after = format_system(text, file);
    EXPECT_EQ(format_system(after, file), after) << file;
    std::size_t comments_before = 0, comments_after = 0;
    for (const char c : text) comments_before += c == '#' ? 1 : 0;
    for (const char c : after) comments_after += c == '#' ? 1 : 0;
    EXPECT_EQ(comments_before, comments_after) << file;
    if (text.find("learn:") != std::string::npos) continue;
    ++parsed;
    EXPECT_TRUE(is_same(parse_system(text, file), parse_system(after, file))) << file;
  }
  EXPECT_GT(files, 30U);
  EXPECT_GT(parsed, 20U);
}

}  // namespace
}  // namespace maide
