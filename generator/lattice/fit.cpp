#include "generator/lattice/fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "generator/lattice/around.hpp"
#include "generator/lattice/balance.hpp"
#include "generator/lattice/contract.hpp"
#include "generator/lattice/exchange.hpp"
#include "generator/lattice/feature.hpp"
#include "generator/lattice/misfit.hpp"
#include "generator/lattice/place.hpp"
#include "generator/lattice/refine.hpp"
#include "generator/lattice/surface_faces.hpp"
#include "generator/parallel/gather.hpp"
#include "generator/parallel/tasks.hpp"
#include "generator/parallel/threads.hpp"
#include "model/sort_unique.hpp"

namespace heart::lattice {
namespace {

// Back onto surfaces and curves, as far as cells allow.
void draw_to_surfaces(Complex& part, const Materials& materials, double least_quality) {
  constexpr int newton_steps = 3;
  constexpr double most_shift = 0.3;  // of the lattice's width
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(part.nodes_mm.size()); ++n) {
    if (part.is_frozen(n) || !is_constrained(part.bits(n)) || part.star(n).empty()) continue;
    const Vec3 way = project(materials, part.bits(n), part.at(n), newton_steps) - part.at(n);
    if (norm(way) < most_shift * static_cast<double>(part.spacing_mm[static_cast<std::size_t>(n)]))
      shift_node(part, n, way, 3, least_quality);
  }
}

/// How a place is worked on.
struct Effort {
  int rings;  // of cells around a face
  int most_tries;
  std::uint32_t seed;  // of shakes
  bool takes_halves;   // is_worth_it
};

/// A place with a misfit in its middle, and the best that was made of it.
struct Job {
  Place place;
  Around around;
  Complex best;  // no cells: nothing better was found
  Fitness fitness;
  std::int64_t work = 0;  // cells repaired, of all tries together
  Face face;              // the misfit, in the whole
  Fitness first;          // before anything was done
  bool is_put_back = false;
};

// The outer ones of some faces that may lie around one of the places.
FacesByHeight outer_faces_near(const Complex& c, const std::vector<SurfaceFace>& faces, const std::vector<Job>& jobs) {
  MarkedCubes cubes(box_around(c.nodes_mm));
  for (const auto& job : jobs) cubes.mark(box_around(job.place.part.nodes_mm));
  std::vector<Face> near;
  for (const auto& face : faces)
    if ((face.labels & bit_of(0)) != 0 && cubes.may_meet(box_of(c, face.nodes))) near.push_back(face.nodes);
  return by_height(c, near);
}

// The faces that places around some misfits, and places around what was made of these, can have around them: of a large
// mesh, few.
std::vector<SurfaceFace> faces_near(const Complex& c, const std::vector<SurfaceFace>& faces,
                                    const std::vector<Face>& misfits) {
  constexpr double margin = 10;  // lattice widths
  MarkedCubes cubes(box_around(c.nodes_mm));
  for (const auto& face : misfits) {
    auto box = box_of(c, face);
    const double reach = margin * static_cast<double>(c.spacing_mm[static_cast<std::size_t>(face[0])]);
    box.low -= Vec3{reach, reach, reach};
    box.high += Vec3{reach, reach, reach};
    cubes.mark(box);
  }
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<SurfaceFace>& near) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f)
      if (cubes.may_meet(box_of(c, faces[f].nodes))) near.push_back(faces[f]);
  };
  return parallel::gather<SurfaceFace>(0, static_cast<std::int64_t>(faces.size()), find);
}

// One way of several to divide a face: its longest edge, the second, the third, in its middle. Then again, a little
// shaken up.
void divide(Complex& part, const Materials& materials, const Face& face, int way, std::uint32_t seed) {
  constexpr int ways = 4;
  constexpr double shake = 0.01;  // of the lattice's width
  if (way >= ways) shake_up(part, materials, shake * way, static_cast<std::uint32_t>(way) + 1000 * seed);
  if (way % ways == 3) {
    pierce_face(part, materials, face);
    return;
  }
  std::array<std::pair<double, std::size_t>, 3> edges;
  for (std::size_t i = 0; i < 3; ++i) edges[i] = {-norm(part.at(face[i]) - part.at(face[(i + 1) % 3])), i};
  std::sort(edges.begin(), edges.end());
  const std::size_t i = edges[static_cast<std::size_t>(way % ways)].second;
  halve_edge(part, materials, face[i], face[(i + 1) % 3]);
}

// Gives cells the regions in which they lie, where that is only a matter of tips and tails: tails go from their end on.
bool relabel_strays(Complex& part, const Materials& materials) {
  constexpr int most_rounds = 6;
  bool is_changed = false;
  for (int round = 0; round < most_rounds; ++round) {
    bool is_changed_now = false;
    for (std::int32_t id = 0; id < static_cast<std::int32_t>(part.cells.size()); ++id) {
      if (!part.is_alive(id) || has_free_node(part, id)) continue;
      const int there = label_if_stray(part, materials, id);
      if (there != 0 && there != part.label_of(id)) is_changed_now = relabel(part, id, there) || is_changed_now;
    }
    if (!is_changed_now) break;
    is_changed = true;
  }
  return is_changed;
}

/// What all tries at a place have in common.
struct Trial {
  const Job* job;
  const Materials* materials;
  const FitSettings* settings;
  RepairSettings repairing;
  std::uint32_t seed;
  double least;         // quality
  std::size_t meeting;  // pairs of outer faces, before
};

Trial trial_of(const Job& job, const Materials& materials, RepairSettings repairing, const FitSettings& settings,
               const Effort& effort) {
  repairing.may_relabel = false;  // labels beyond the place are not seen
  repairing.goal = repairing.least = settings.enough + 0.0004;
  repairing.sweeps = 6;        // without shakes: another way is cheaper
  repairing.tolerance = 0.08;  // else nodes leave the crease that they were put on
  const double least = std::min(settings.enough, worst_quality(job.place.part));
  return {&job, &materials, &settings, repairing, effort.seed, least, count_meeting(job.place.part, job.around)};
}

struct Outcome {
  Complex made;
  Fitness fitness;
  bool is_better = false;
};

const Complex& best_of(const Job& job) { return job.best.cells.empty() ? job.place.part : job.best; }

bool has_strays(const Job& job, const Materials& materials) {
  Complex tried = best_of(job);
  return relabel_strays(tried, materials);
}

// Way 0 relabels, the others divide the worst face; then what that makes is repaired.
Outcome try_way(const Trial& trial, int way) {
  const auto& job = *trial.job;
  const auto& materials = *trial.materials;
  Outcome outcome{best_of(job), {}};
  auto& made = outcome.made;
  if (way == 0)
    relabel_strays(made, materials);
  else
    divide(made, materials, job.fitness.worst, way - 1, trial.seed);
  repair(made, materials, trial.repairing);
  draw_to_surfaces(made, materials, trial.settings->enough);
  balance_surfaces(made, materials, trial.settings->enough);
  outcome.fitness = fitness_of(made, materials, *trial.settings);
  outcome.is_better = outcome.fitness.misery < job.fitness.misery && worst_quality(made) >= trial.least &&
                      count_meeting(made, job.around) <= trial.meeting;
  return outcome;
}

// The outcomes of some ways, the first one included, all at the same time.
std::vector<Outcome> try_ways(const Trial& trial, int first, int count) {
  std::vector<Outcome> outcomes(static_cast<std::size_t>(count));
  std::vector<std::function<void()>> tasks;
  tasks.reserve(outcomes.size());
  for (int i = 0; i < count; ++i)
    tasks.emplace_back([&, i] { outcomes[static_cast<std::size_t>(i)] = try_way(trial, first + i); });
  if (count == 1)
    tasks.front()();
  else
    parallel::run_tasks(tasks);
  return outcomes;
}

// Goes on from the first outcome that is better, until none is. What is tried `at_once` beyond that one is forgotten:
// the result is the same as one by one.
void fit(Job& job, const Materials& materials, const RepairSettings& repairing, const FitSettings& settings,
         const Effort& effort, int at_once) {
  job.first = job.fitness = fitness_of(job.place.part, materials, settings);
  const auto trial = trial_of(job, materials, repairing, settings, effort);
  const auto first_way = [&] { return has_strays(job, materials) ? 0 : 1; };
  int left = effort.most_tries, way = first_way();
  while (left > 0 && job.fitness.misery > 0) {
    auto outcomes = try_ways(trial, way, std::min(at_once, left));
    const auto better = std::ranges::find_if(outcomes, &Outcome::is_better);
    const bool is_better = better != outcomes.end();
    const auto tried = static_cast<int>(better - outcomes.begin()) + (is_better ? 1 : 0);
    left -= tried;
    job.work += tried * static_cast<std::int64_t>(job.place.part.cells.size());
    if (is_better) {
      job.fitness = better->fitness;
      job.best = std::move(better->made);
    }
    way = is_better ? first_way() : way + tried;
  }
}

// Places around the worst faces, none of which shares a node with another one; `faces` keeps those beside them, and
// those for which the work that is left would not do.
std::vector<Job> separate_places(const Complex& c, std::vector<Face>& faces, int rings, std::int64_t work_left) {
  constexpr std::int64_t usual_tries = 6;
  std::vector<Job> jobs;
  std::vector<std::uint8_t> is_taken(c.nodes_mm.size(), 0);
  const auto is_done = [&](const Face& face) {
    const auto cell = cells_at_face(c, face[0], face[1], face[2])[0];
    if (cell < 0) return true;  // what was made of another place changed it
    if (work_left <= 0) return false;
    const auto taken = [&](std::int32_t n) { return is_taken[static_cast<std::size_t>(n)] != 0; };
    if (std::any_of(face.begin(), face.end(), taken)) return false;
    auto place = place_around(c, cell, rings);
    if (std::any_of(place.nodes.begin(), place.nodes.end(), taken)) return false;
    for (const auto n : place.nodes) is_taken[static_cast<std::size_t>(n)] = 1;
    work_left -= usual_tries * static_cast<std::int64_t>(place.cells.size());
    jobs.push_back({std::move(place), {}, {}, {}, 0, face, {}});
    return true;
  };
  std::erase_if(faces, is_done);
  return jobs;
}

Face in_whole(const Place& place, Face face) {
  for (auto& n : face) n = place.nodes[static_cast<std::size_t>(n)];
  return sorted(face);
}

/// A mesh that is being fitted.
struct Fitting {
  Complex* complex;
  const Materials* materials;
  const RepairSettings* repairing;
  const FitSettings* settings;
  std::vector<SurfaceFace> faces;     // of the mesh as it is; once misfits are known, near them
  std::vector<std::int32_t> changed;  // nodes of places that were put back
  std::int64_t work_left;
};

// What is better but leaves as many misfits may be in the way of a greater effort; far off, anything better is welcome.
bool is_worth_it(const Job& job, const Effort& effort, double aim) {
  if (job.best.cells.empty()) return false;
  return effort.takes_halves || job.fitness.misfits < job.first.misfits || job.first.error > 2 * aim;
}

void put_back(Fitting& fitting, std::vector<Job>& jobs, const Effort& effort) {
  std::vector<std::int32_t> changed;
  for (auto& job : jobs) {
    fitting.work_left -= job.work;
    if (!is_worth_it(job, effort, fitting.settings->aim)) continue;
    put_back(*fitting.complex, job.place, job.best);
    job.is_put_back = true;
    changed.insert(changed.end(), job.place.nodes.begin(), job.place.nodes.end());
  }
  renew_faces(fitting.faces, *fitting.complex, changed);
  fitting.changed.insert(fitting.changed.end(), changed.begin(), changed.end());
}

// Works on the places around some faces as long as there is work left; returns the worst faces of those where the aim
// is missed.
std::vector<Face> fit_places(Fitting& fitting, std::vector<Face> faces, const Effort& effort) {
  const auto& complex = *fitting.complex;
  std::vector<Face> missed;
  while (!faces.empty() && fitting.work_left > 0) {
    auto jobs = separate_places(complex, faces, effort.rings, fitting.work_left);
    if (jobs.empty()) break;
    const auto outer = outer_faces_near(complex, fitting.faces, jobs);
    std::vector<std::function<void()>> tasks;
    tasks.reserve(jobs.size());
    const int at_once = jobs.size() == 1 ? parallel::thread_count() : 1;
    for (auto& job : jobs)
      tasks.emplace_back([&] {
        job.around = faces_around(complex, outer, job.place);
        fit(job, *fitting.materials, *fitting.repairing, *fitting.settings, effort, at_once);
      });
    if (jobs.size() == 1)
      tasks.front()();
    else
      parallel::run_tasks(tasks);
    put_back(fitting, jobs, effort);
    for (const auto& job : jobs)
      if (job.fitness.misery > 0) missed.push_back(job.is_put_back ? in_whole(job.place, job.fitness.worst) : job.face);
  }
  missed.insert(missed.end(), faces.begin(), faces.end());
  return missed;
}

// What is made of places can change faces beside them: those that have changed, and those that were misfits before.
std::vector<SurfaceFace> suspects(Fitting& fitting, std::vector<Face> before) {
  std::sort(before.begin(), before.end());
  sort_unique(fitting.changed);
  auto faces = fitting.faces;
  std::erase_if(faces, [&](const SurfaceFace& face) {
    return std::none_of(face.nodes.begin(), face.nodes.end(),
                        [&](std::int32_t n) { return std::ranges::binary_search(fitting.changed, n); }) &&
           !std::binary_search(before.begin(), before.end(), sorted(face.nodes));
  });
  return faces;
}

}  // namespace

std::int64_t fit_faces(Complex& complex, const Materials& materials, const RepairSettings& repairing,
                       const FitSettings& settings) {
  // Most places need little, and work that some waste others lack.
  constexpr std::array efforts{Effort{2, 10, 0, false}, Effort{3, 10, 0, false}, Effort{3, 20, 1, true},
                               Effort{3, 30, 2, true}};
  constexpr std::size_t usual_cells = 1'500'000;
  const auto cells = std::max(complex.cells.size(), usual_cells);  // of a small mesh, all may be creases
  Fitting fitting{&complex, &materials, &repairing, &settings, surface_faces(complex), {}, 0};
  fitting.work_left = static_cast<std::int64_t>(settings.most_work * static_cast<double>(cells));
  const auto found = misfits(complex, materials, settings, fitting.faces);
  fitting.faces = faces_near(complex, fitting.faces, found);
  auto missed = found;
  for (const auto& effort : efforts) missed = fit_places(fitting, std::move(missed), effort);
  std::sort(missed.begin(), missed.end());
  auto late = misfits(complex, materials, settings, suspects(fitting, found));
  std::erase_if(late, [&](const Face& face) { return std::binary_search(missed.begin(), missed.end(), face); });
  const auto again = fit_places(fitting, std::move(late), efforts.front());
  return static_cast<std::int64_t>(missed.size() + again.size());
}

}  // namespace heart::lattice
