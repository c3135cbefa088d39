#pragma once

#include <string>
#include <vector>

#include "tests/project/markdown.hpp"

namespace aloft::test {

/// The commands of a document's blocks of shell code, in order, without their comments.
[[nodiscard]] std::vector<Located> commands_of(const Document& document);

/// The words of a command, as a shell splits them.
[[nodiscard]] std::vector<std::string> shell_words(const std::string& command);

}  // namespace aloft::test
