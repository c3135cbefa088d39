// The table of topics, and that SECURITY.md shows it.
#include "common/bus/topics.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include "tests/paths.hpp"

namespace aloft {
namespace {

const std::filesystem::path document = test::source_dir() / "SECURITY.md";

std::string document_text() {
  std::ifstream stream(document);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The topics that a role writes or reads. RunControl, which all read, has a sentence of its own.
std::string topics_of(security::Role role, security::Roles bus::TopicSettings::*who) {
  std::string names;
  for (const bus::TopicSettings* topic : bus::all_topics())
    if ((topic->*who).contain(role) && !(who == &bus::TopicSettings::readers && topic->name == "RunControl"))
      names += (names.empty() ? "" : ", ") + std::string(topic->name);
  return names.empty() ? "nothing" : names;
}

std::string table_of_roles() {
  const std::map<security::Role, std::string> commands{
      {security::Role::observer, " (`aloft run`, `worker`, `status`, `live`)"},
      {security::Role::run_operator, " (`aloft swap`, `live --operator`)"}};
  std::string table = "| role | writes | reads |\n|---|---|---|\n";
  for (const security::Role role : security::all_roles) {
    table += "| `" + std::string(to_text(role)) + "`" + (commands.contains(role) ? commands.at(role) : "");
    table += " | " + topics_of(role, &bus::TopicSettings::writers);
    table += " | " + topics_of(role, &bus::TopicSettings::readers) + " |\n";
  }
  return table;
}

/// The position of the table in the document.
std::pair<std::size_t, std::size_t> place_of_table(const std::string& text) {
  const std::size_t begin = text.find("| role |");
  const std::size_t end = text.find("\n\n", begin) + 1;
  REQUIRE(begin < end);
  return {begin, end - begin};
}

}  // namespace

TEST_CASE("SECURITY.md shows which role may write and read what") {
  INFO("tools/reference.sh writes the table anew");
  const std::string text = document_text();
  const auto [begin, size] = place_of_table(text);
  CHECK(text.substr(begin, size) == table_of_roles());
  for (const security::Role role : security::all_roles)
    CHECK(bus::topic_settings<wire::RunControl>().readers.contain(role));
}

TEST_CASE("writes the table of SECURITY.md anew", "[.regenerate]") {
  std::string text = document_text();
  const auto [begin, size] = place_of_table(text);
  std::ofstream(document) << text.replace(begin, size, table_of_roles());
}

}  // namespace aloft
