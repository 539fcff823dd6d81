#include "generator/app/options.hpp"

#include "generator/labels/presets.hpp"

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

std::string preset_names() {
  std::string names;
  for (const auto& preset : labels::label_presets()) names += (names.empty() ? "" : ", ") + std::string(preset.name);
  return names;
}

void add_machine_options(Program& p, CLI::App& app) {
  app.add_option("--threads", p.threads, "threads per process (default: all)");
  app.add_option(
      "--simd", p.simd,
      "vector instructions at most: plain, avx2 or avx512 (default: the processor's best; the same results)");
  app.add_option("--memory-limit", p.memory_limit,
                 "refuse work that needs more memory, e.g. 8G (default: what the machine, cgroups and ulimits leave)");
}

void add_heart_options(Program& p, CLI::App& sub, datasets::HeartOverrides& heart) {
  sub.add_option("--lv-wall", heart.lv_wall_mm, "mm, the left ventricle's wall, 5 to 18 (default: the variant's)");
  sub.add_option("--rv-wall", heart.rv_wall_mm, "mm, the right ventricle's, 2.5 to 8");
  sub.add_option("--heart-size", heart.scale, "over the usual, 0.8 to 1.25");
  sub.add_option("--heart-rotation", p.rotation, "degrees about the patient's axes RX,RY,RZ, each -30 to 30")
      ->delimiter(',')
      ->expected(3);
}

}  // namespace heart::app
