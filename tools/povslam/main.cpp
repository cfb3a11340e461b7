// povslam: the tool beside the daemon.
#include <CLI/CLI.hpp>

#include "tools/povslam/subcommands.hpp"

int main(int argc, char** argv) {
  CLI::App app{"povslam: localisation among things that move. See `povslam SUBCOMMAND --help`.", "povslam"};
  app.set_version_flag("--version", POVSLAM_VERSION);
  app.require_subcommand(0, 1);  // none is asked for below: CLI11 would say so of a misspelt one as well
  int exit_code = 0;
  povslam::add_replay(app, exit_code);
  povslam::add_simulate(app, exit_code);
  povslam::add_evaluate(app, exit_code);
  povslam::add_listen(app, exit_code);
  povslam::add_map(app, exit_code);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) throw CLI::RequiredError("A subcommand");
  } catch (const CLI::ParseError& error) {
    const int cli_code = app.exit(error);
    return cli_code == 0 ? 0 : 2;
  }
  return exit_code;
}
