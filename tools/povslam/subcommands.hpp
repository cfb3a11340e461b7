// The tool's subcommands, one file each. add_X declares options on `app` and sets exit_code when the subcommand ran:
// 0 success, 1 failure, 2 bad usage or configuration.
#pragma once

namespace CLI {
class App;
}

namespace povslam {

void add_replay(CLI::App& app, int& exit_code);
void add_simulate(CLI::App& app, int& exit_code);
void add_evaluate(CLI::App& app, int& exit_code);
void add_listen(CLI::App& app, int& exit_code);
void add_map(CLI::App& app, int& exit_code);

}  // namespace povslam
