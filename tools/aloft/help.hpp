#pragma once

#include "tools/aloft/commands.hpp"

namespace aloft::cli {

void add_help(CLI::App& app, Job& job);

/// Puts examples at the end of the help of every command; all of them must be there already.
void add_examples(CLI::App& app);

}  // namespace aloft::cli
