#include "generator/app/options.hpp"

namespace heart::app {

CLI::App* subcommand(Program& p, const std::string& name, const std::string& what, const std::string& example,
                     std::function<int()> action) {
  auto* sub = p.app.add_subcommand(name, what);
  sub->footer("Example:\n  " + example);
  sub->callback([&p, action = std::move(action)] { p.chosen = action; });
  return sub;
}

std::function<int()> on_root(Program& p, std::function<int()> action) {
  return [&p, action = std::move(action)] { return parallel::run_on_root(p.comm, action); };
}

}  // namespace heart::app
