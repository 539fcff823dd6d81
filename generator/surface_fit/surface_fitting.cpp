// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/surface_fit/surface_fitting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "generator/parallel/gather.hpp"
#include "generator/parallel/tasks.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/stuffing/refine.hpp"
#include "generator/surface_fit/cavity_boundary.hpp"
#include "generator/surface_fit/change_face.hpp"
#include "generator/surface_fit/marked_cubes.hpp"
#include "generator/surface_fit/volume_correction.hpp"
#include "generator/tetmesh/cavity.hpp"
#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/flips.hpp"
#include "generator/tetmesh/surface_deviation.hpp"
#include "generator/tetmesh/surface_faces.hpp"
#include "model/contract.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::surface_fit {
namespace {

// Back onto surfaces and curves, as far as cells allow.
void draw_to_surfaces(tetmesh::Complex& part, const tetmesh::Materials& materials, double min_quality) {
  constexpr int newton_steps = 3;
  constexpr double max_shift = 0.3;  // of the lattice's width
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(part.nodes_mm.size()); ++n) {
    if (part.is_frozen(n) || !tetmesh::is_constrained(part.bits(n)) || part.star(n).empty()) continue;
    const Vec3 way = tetmesh::project(materials, part.bits(n), part.at(n), newton_steps) - part.at(n);
    if (norm(way) < max_shift * static_cast<double>(part.spacing_mm[static_cast<std::size_t>(n)]))
      tetmesh::shift_node(part, n, way, 3, min_quality);
  }
}

/// How a place is worked on.
struct Effort {
  int rings;  // of cells around a face
  int max_tries;
  std::uint32_t seed;  // of shakes
  bool takes_halves;   // is_worth_it
  bool spares_faces;   // that fit: on the way to something better they may have to become misfits
};

/// What one try made of a place.
struct Outcome {
  tetmesh::Complex made;
  tetmesh::Fitness fitness;
  bool is_better = false;
};

/// A place with a misfit in its middle, and the best that was made of it.
struct Job {
  tetmesh::Cavity place;
  Face face;  // the misfit, in the whole
  CavityBoundary around;
  std::size_t meeting = 0;  // pairs of outer faces, before anything was done
  double least = 0;         // quality that must be kept
  tetmesh::Fitness first;   // before anything was done
  tetmesh::Fitness fitness;
  tetmesh::Complex best;          // no cells: nothing better was found
  int left = 0;                   // tries
  int way = 0;                    // the next one
  std::vector<Outcome> outcomes;  // of ways that are tried at the same time
  std::int64_t work = 0;          // cells repaired, of all tries together
  bool is_put_back = false;

  bool is_active() const { return left > 0 && fitness.penalty > 0; }
};

// The outer ones of some faces that may lie around one of the places.
FacesByHeight outer_faces_near(const tetmesh::Complex& c, const std::vector<tetmesh::SurfaceFace>& faces,
                               const std::vector<Job>& jobs) {
  std::vector<tetmesh::Box> places;
  places.reserve(jobs.size());
  for (const auto& job : jobs) places.push_back(reach_of(job.place));
  const MarkedCubes cubes(places);
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Face>& near) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f)
      if ((faces[f].labels & tetmesh::bit_of(0)) != 0 && cubes.may_meet(tetmesh::box_of(c, faces[f].nodes)))
        near.push_back(faces[f].nodes);
  };
  return by_height(c, parallel::gather<Face>(0, static_cast<std::int64_t>(faces.size()), find));
}

// The faces that places around some misfits, and places around what was made of these, can have around them: of a large
// mesh, few.
std::vector<tetmesh::SurfaceFace> faces_near(const tetmesh::Complex& c, const std::vector<tetmesh::SurfaceFace>& faces,
                                             const std::vector<Face>& deviating_faces) {
  constexpr double margin = 10;  // lattice widths
  std::vector<tetmesh::Box> boxes;
  boxes.reserve(deviating_faces.size());
  for (const auto& face : deviating_faces) {
    auto& box = boxes.emplace_back(tetmesh::box_of(c, face));
    const double reach = margin * static_cast<double>(c.spacing_mm[static_cast<std::size_t>(face[0])]);
    box.low -= Vec3{reach, reach, reach};
    box.high += Vec3{reach, reach, reach};
  }
  const MarkedCubes cubes(boxes);
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<tetmesh::SurfaceFace>& near) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f)
      if (cubes.may_meet(tetmesh::box_of(c, faces[f].nodes))) near.push_back(faces[f]);
  };
  return parallel::gather<tetmesh::SurfaceFace>(0, static_cast<std::int64_t>(faces.size()), find);
}

// Gives cells the regions in which they lie, where that is only a matter of tips and tails: tails go from their end on.
bool relabel_strays(tetmesh::Complex& part, const tetmesh::Materials& materials) {
  constexpr int max_rounds = 6;
  bool is_changed = false;
  for (int round = 0; round < max_rounds; ++round) {
    bool is_changed_now = false;
    for (std::int32_t id = 0; id < static_cast<std::int32_t>(part.cells.size()); ++id) {
      if (!part.is_alive(id) || stuffing::has_free_node(part, id)) continue;
      const int there = stuffing::label_if_mislabelled(part, materials, id);
      if (there != part.label_of(id)) is_changed_now = tetmesh::relabel(part, id, there) || is_changed_now;
    }
    if (!is_changed_now) break;
    is_changed = true;
  }
  return is_changed;
}

/// What all tries have in common.
struct Trial {
  const tetmesh::Materials* materials;
  const FitSettings* settings;
  tetmesh::RepairSettings repairing;
  const Effort* effort;
};

Trial trial_of(const tetmesh::Materials& materials, tetmesh::RepairSettings repairing, const FitSettings& settings,
               const Effort& effort) {
  repairing.may_relabel = false;  // labels beyond the place are not seen
  repairing.goal = repairing.least = settings.enough + 0.0004;
  if (effort.spares_faces) repairing.face = settings.aim;
  repairing.sweeps = 6;        // without shakes: another way is cheaper
  repairing.tolerance = 0.08;  // else nodes leave the crease that they were put on
  return {&materials, &settings, repairing, &effort};
}

const tetmesh::Complex& best_of(const Job& job) { return job.best.cells.empty() ? job.place.part : job.best; }

// Way 0 relabels, the others change the worst face.
int first_way(const Job& job, const tetmesh::Materials& materials) {
  tetmesh::Complex tried = best_of(job);
  return relabel_strays(tried, materials) ? 0 : 1;
}

void begin(Job& job, const Trial& trial) {
  const auto& part = job.place.part;
  job.meeting = count_meeting(part, job.around);
  job.least = std::min(trial.settings->enough, tetmesh::worst_quality(part));
  job.first = job.fitness = tetmesh::fitness_of(part, *trial.materials, trial.settings->aim, trial.settings->labels);
  job.left = trial.effort->max_tries;
  job.way = first_way(job, *trial.materials);
}

// A node less leaves less to try: only where a misfit goes with it.
bool gains_enough(const tetmesh::Fitness& made, const tetmesh::Fitness& before, int way) {
  const bool is_smaller = way > 0 && takes_node_away(way - 1);
  return made.penalty < before.penalty && (!is_smaller || made.deviating_faces < before.deviating_faces);
}

Outcome try_way(const Job& job, const Trial& trial, int way) {
  const auto& materials = *trial.materials;
  Outcome outcome{best_of(job), {}};
  auto& made = outcome.made;
  if (way == 0)
    relabel_strays(made, materials);
  else
    change_face(made, materials, job.fitness.worst, way - 1, trial.effort->seed);
  tetmesh::repair(made, materials, trial.repairing);
  draw_to_surfaces(made, materials, trial.settings->enough);
  correct_surface_volumes(made, materials, trial.settings->enough);
  outcome.fitness = tetmesh::fitness_of(made, materials, trial.settings->aim, trial.settings->labels);
  outcome.is_better = gains_enough(outcome.fitness, job.fitness, way) && tetmesh::worst_quality(made) >= job.least &&
                      is_within_reach(made, job.around) && count_meeting(made, job.around) <= job.meeting;
  return outcome;
}

// Goes on from the first outcome that is better. What was tried beyond it is forgotten: the result is the same as one
// by one.
void choose(Job& job, const tetmesh::Materials& materials) {
  const auto better = std::ranges::find_if(job.outcomes, &Outcome::is_better);
  const bool is_better = better != job.outcomes.end();
  const auto tried = static_cast<int>(better - job.outcomes.begin()) + (is_better ? 1 : 0);
  job.left -= tried;
  job.way += tried;
  job.work += tried * static_cast<std::int64_t>(job.place.part.cells.size());
  if (is_better) {
    job.fitness = better->fitness;
    job.best = std::move(better->made);
    job.way = first_way(job, materials);
  }
  job.outcomes.clear();
}

std::vector<Job*> pointers_to(std::vector<Job>& jobs) {
  std::vector<Job*> pointers;
  pointers.reserve(jobs.size());
  for (auto& job : jobs) pointers.push_back(&job);
  return pointers;
}

// Calls work(job) for each, all at the same time.
template <class Work>
void for_each_job(const std::vector<Job*>& jobs, const Work& work) {
  std::vector<std::function<void()>> tasks;
  tasks.reserve(jobs.size());
  for (auto* job : jobs) tasks.emplace_back([&work, job] { work(*job); });
  parallel::run_tasks(tasks);
}

// Enough jobs for all threads: some tries of each, one after the other, so that threads seldom wait for each other.
void try_in_turn(const std::vector<Job*>& jobs, const Trial& trial) {
  constexpr int tries = 4;
  for_each_job(jobs, [&](Job& job) {
    for (int i = 0; i < tries && job.is_active(); ++i) {
      job.outcomes.push_back(try_way(job, trial, job.way));
      choose(job, *trial.materials);
    }
  });
}

// So few jobs that threads would have nothing to do: several ways of each at the same time.
void try_at_once(const std::vector<Job*>& jobs, const Trial& trial) {
  std::vector<std::function<void()>> tasks;
  const auto threads = static_cast<std::size_t>(parallel::thread_count());
  const auto at_once = static_cast<int>(threads / std::gcd(jobs.size(), threads));
  for (auto* job : jobs) {
    job->outcomes.resize(static_cast<std::size_t>(std::min(at_once, job->left)));
    for (std::size_t i = 0; i < job->outcomes.size(); ++i)
      tasks.emplace_back([&trial, job, i] { job->outcomes[i] = try_way(*job, trial, job->way + static_cast<int>(i)); });
  }
  parallel::run_tasks(tasks);
  for_each_job(jobs, [&](Job& job) { choose(job, *trial.materials); });
}

Face in_whole(const tetmesh::Cavity& place, Face face) {
  for (auto& n : face) n = place.nodes[static_cast<std::size_t>(n)];
  return tetmesh::sorted(face);
}

void fit(std::vector<Job>& jobs, const Trial& trial, const std::vector<Face>& hopeless) {
  auto active = pointers_to(jobs);
  for_each_job(active, [&](Job& job) { begin(job, trial); });
  for (auto& job : jobs)
    if (job.is_active() && std::ranges::find(hopeless, in_whole(job.place, job.first.worst)) != hopeless.end())
      job.left = 0;
  for (;;) {
    std::erase_if(active, [](const Job* job) { return !job->is_active(); });
    if (active.empty()) return;
    const bool are_enough = active.size() >= 2 * static_cast<std::size_t>(parallel::thread_count());
    are_enough ? try_in_turn(active, trial) : try_at_once(active, trial);
  }
}

// Places around the worst faces, none of which shares a node with another one; `faces` keeps those beside them, and
// those for which the work that is left would not do.
std::vector<Job> separate_places(const tetmesh::Complex& c, std::vector<Face>& faces, int rings,
                                 std::int64_t work_left) {
  constexpr std::int64_t default_tries = 6;
  std::vector<Job> jobs;
  std::vector<std::uint8_t> is_taken(c.nodes_mm.size(), 0);
  const auto is_done = [&](const Face& face) {
    const auto cell = tetmesh::cells_at_face(c, face[0], face[1], face[2])[0];
    if (cell < 0) return true;  // what was made of another place changed it
    if (work_left <= 0) return false;
    auto cells = tetmesh::free_cells_around(c, cell, rings, is_taken);
    if (cells.empty()) return false;
    for (const auto n : tetmesh::nodes_of(c, cells)) is_taken[static_cast<std::size_t>(n)] = 1;
    work_left -= default_tries * static_cast<std::int64_t>(cells.size());
    auto& job = jobs.emplace_back();
    job.place.cells = std::move(cells);
    job.face = face;
    return true;
  };
  std::erase_if(faces, is_done);
  for_each_job(pointers_to(jobs),
               [&](Job& job) { job.place = tetmesh::extract_cavity(c, std::move(job.place.cells)); });
  return jobs;
}

/// A mesh that is being fitted.
struct Fitting {
  tetmesh::Complex* complex;
  const tetmesh::Materials* materials;
  const tetmesh::RepairSettings* repairing;
  const FitSettings* settings;
  std::vector<tetmesh::SurfaceFace> faces;  // of the mesh as it is; once misfits are known, near them
  std::vector<std::int32_t> changed;        // nodes of places that were put back
  std::int64_t work_left;
};

// What is better but leaves as many misfits may be in the way of a greater effort; far off, anything better is welcome.
bool is_worth_it(const Job& job, const Effort& effort, double aim) {
  if (job.best.cells.empty()) return false;
  return effort.takes_halves || job.fitness.deviating_faces < job.first.deviating_faces || job.first.error > 2 * aim;
}

void reinsert_cavity(Fitting& fitting, std::vector<Job>& jobs, const Effort& effort) {
  std::vector<std::int32_t> changed;
  for (auto& job : jobs) {
    fitting.work_left -= job.work;
    if (!is_worth_it(job, effort, fitting.settings->aim)) continue;
    reinsert_cavity(*fitting.complex, job.place, job.best);
    job.is_put_back = true;
    changed.insert(changed.end(), job.place.nodes.begin(), job.place.nodes.end());
  }
  tetmesh::renew_faces(fitting.faces, *fitting.complex, changed);
  fitting.changed.insert(fitting.changed.end(), changed.begin(), changed.end());
}

// Works on the places around some faces as long as there is work left; returns the worst faces of those where the aim
// is missed.
std::vector<Face> fit_places(Fitting& fitting, std::vector<Face> faces, const Effort& effort) {
  const auto& complex = *fitting.complex;
  const auto trial = trial_of(*fitting.materials, *fitting.repairing, *fitting.settings, effort);
  std::vector<Face> missed, hopeless;  // the worst faces of places, and of those that were tried in vain
  while (!faces.empty() && fitting.work_left > 0) {
    auto jobs = separate_places(complex, faces, effort.rings, fitting.work_left);
    if (jobs.empty()) break;
    const auto outer = outer_faces_near(complex, fitting.faces, jobs);
    for (auto& job : jobs) job.around = faces_around(complex, outer, job.place);
    fit(jobs, trial, hopeless);
    reinsert_cavity(fitting, jobs, effort);
    for (const auto& job : jobs) {
      if (job.fitness.penalty <= 0) continue;
      const auto& now = job.is_put_back ? job.fitness : job.first;
      const auto worst = in_whole(job.place, now.worst);
      hopeless.push_back(worst);
      missed.push_back(job.is_put_back ? worst : job.face);
    }
  }
  missed.insert(missed.end(), faces.begin(), faces.end());
  return missed;
}

// What is made of places can change faces beside them: those that have changed, and those that were misfits before.
std::vector<tetmesh::SurfaceFace> suspects(Fitting& fitting, std::vector<Face> before) {
  std::sort(before.begin(), before.end());
  sort_unique(fitting.changed);
  const auto is_suspect = [&](const tetmesh::SurfaceFace& face) {
    return std::ranges::any_of(face.nodes, [&](auto n) { return std::ranges::binary_search(fitting.changed, n); }) ||
           std::ranges::binary_search(before, tetmesh::sorted(face.nodes));
  };
  const auto& faces = fitting.faces;
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<tetmesh::SurfaceFace>& found) {
    std::copy_if(faces.begin() + begin, faces.begin() + end, std::back_inserter(found), is_suspect);
  };
  return parallel::gather<tetmesh::SurfaceFace>(0, std::ssize(faces), find);
}

}  // namespace

std::int64_t fit_surfaces(tetmesh::Complex& complex, const tetmesh::Materials& materials,
                          const tetmesh::RepairSettings& repairing, const FitSettings& settings) {
  HEARTGEN_INVARIANT(tetmesh::has_derived_touches(complex));
  // Most places need little, and work that some waste others lack: each way once, then more. What resists needs
  // something else, not more of the same.
  constexpr std::array efforts{
      Effort{.rings = 2, .max_tries = 5, .seed = 0, .takes_halves = false, .spares_faces = true},
      Effort{.rings = 2, .max_tries = 10, .seed = 3, .takes_halves = false, .spares_faces = true},
      Effort{.rings = 3, .max_tries = 10, .seed = 0, .takes_halves = false, .spares_faces = true},
      Effort{.rings = 3, .max_tries = 20, .seed = 1, .takes_halves = true, .spares_faces = false},
      Effort{.rings = 4, .max_tries = 20, .seed = 2, .takes_halves = true, .spares_faces = true},
      Effort{.rings = 3, .max_tries = 20, .seed = 4, .takes_halves = true, .spares_faces = true}};
  constexpr std::size_t typical_cells = 1'500'000;
  const auto cells = std::max(complex.cells.size(), typical_cells);  // of a small mesh, all may be creases
  Fitting fitting{&complex, &materials, &repairing, &settings, tetmesh::surface_faces(complex), {}, 0};
  fitting.work_left = static_cast<std::int64_t>(settings.max_work * static_cast<double>(cells));
  const auto found = tetmesh::deviating_faces(complex, materials, settings.aim, settings.labels, fitting.faces);
  fitting.faces = faces_near(complex, fitting.faces, found);
  auto missed = found;
  for (const auto& effort : efforts) missed = fit_places(fitting, std::move(missed), effort);
  std::sort(missed.begin(), missed.end());
  auto late = tetmesh::deviating_faces(complex, materials, settings.aim, settings.labels, suspects(fitting, found));
  std::erase_if(late, [&](const Face& face) { return std::binary_search(missed.begin(), missed.end(), face); });
  const auto again = fit_places(fitting, std::move(late), efforts.front());
  return static_cast<std::int64_t>(missed.size() + again.size());
}

}  // namespace heartgen::surface_fit
