#include "tests/project/command_lines.hpp"

#include <regex>

namespace aloft::test {
namespace {

std::string without_comment(const std::string& line) {
  static const std::regex comment(R"((^|\s+)#\s.*$)");
  return std::regex_replace(line, comment, "");
}

}  // namespace

std::vector<Located> commands_of(const Document& document) {
  std::vector<Located> commands;
  for (const CodeBlock& block : document.code_blocks) {
    if (block.language != "sh") continue;
    int line = block.line;
    for (const std::string& code : block.code) {
      if (std::string command = without_comment(code); !command.empty()) commands.push_back({line, std::move(command)});
      ++line;
    }
  }
  return commands;
}

std::vector<std::string> shell_words(const std::string& command) {
  static const std::regex word(R"('([^']*)'|"([^"]*)\"|([^\s'"]+))");
  std::vector<std::string> words;
  for (auto match = std::sregex_iterator(command.begin(), command.end(), word); match != std::sregex_iterator();
       ++match)
    words.push_back((*match)[1].str() + (*match)[2].str() + (*match)[3].str());
  return words;
}

}  // namespace aloft::test
