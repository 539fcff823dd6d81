// SPDX-License-Identifier: GPL-3.0-or-later
#include <heartgen/images.hpp>
#include <heartgen/labels.hpp>
#include <heartgen/landmarks.hpp>
#include <heartgen/pde.hpp>
#include <map>

#include "arrays.hpp"
#include "module.hpp"

namespace heartgen::python {
namespace {

py::list texts_of(const std::vector<Warning>& warnings) {
  py::list texts;
  for (const auto& warning : warnings) texts.append(warning.text);
  return texts;
}

void add_files(py::module_& m) {
  m.def("read_image", [](const std::string& path) { return image_of(unlocked([&] { return read_image(path); })); });
  m.def("read_ct", [](const std::string& path) { return image_of(unlocked([&] { return read_ct(path); })); });
  m.def("read_labels", [](const std::string& path, const std::string& preset, const std::string& names) {
    auto map = unlocked([&] { return read_label_map(path, preset, names); });
    return py::make_tuple(image_of(std::move(map.labels)), texts_of(map.warnings));
  });
  m.def("write_image", [](const std::string& path, const py::array& array, const Geometry& g) {
    const auto write = [&](auto zero) {
      const auto volume = volume_of<decltype(zero)>(array, g);
      unlocked([&] { write_volume(path, volume); });
    };
    const auto is = [&](auto zero) { return py::isinstance<py::array_t<decltype(zero)>>(array); };
    if (is(std::uint8_t{}) || is(bool{})) return write(std::uint8_t{});
    if (is(std::int16_t{})) return write(std::int16_t{});
    write(float{});
  });
}

py::list filter_table() {
  py::list table;
  for (const auto& filter : pde::filters()) {
    py::list parameters;
    for (const auto& p : filter.parameters) parameters.append(py::make_tuple(p.name, p.default_value, p.help));
    table.append(py::make_tuple(filter.name, filter.help, filter.equation, parameters));
  }
  return table;
}

py::tuple chan_vese(const Array<float>& array, const Array<std::uint8_t>& domain, const Geometry& g,
                    const std::string& norm, double lambda, double mu, int max_iterations) {
  if (norm != "l1" && norm != "l2") throw UserError("unknown \"" + norm + "\"", "norm", "give \"l1\" or \"l2\"");
  pde::ChanVeseSettings settings{.lambda = lambda, .mu = mu, .max_iterations = max_iterations};
  settings.norm = norm == "l1" ? pde::Norm::l1 : pde::Norm::l2;
  const auto image = volume_of(array, g);
  const auto mask = volume_of(domain, g);
  if (mask.grid.size != image.grid.size) throw UserError("has another shape than the image", "domain", "give one mask");
  auto found = unlocked([&] { return pde::chan_vese(image, mask, settings, parallel::self()); });
  return py::make_tuple(array_of(std::move(found.above)), found.c_below, found.c_above, found.iterations,
                        found.converged, found.energy);
}

py::dict segment(const Array<float>& array, const Geometry& g, const std::vector<py::dict>& given) {
  std::vector<SegmentationStep> steps;
  for (const auto& step : given) set_members(steps.emplace_back(), step, "step");
  const auto image = volume_of(array, g);
  auto tree = unlocked([&] { return pde::segment(image, steps, parallel::self()); });
  py::dict sides;
  for (auto& side : tree) {
    sides[py::str(side.name + ".below")] = py::make_tuple(array_of(std::move(side.below)), side.c_below);
    sides[py::str(side.name + ".above")] = py::make_tuple(array_of(std::move(side.above)), side.c_above);
  }
  return sides;
}

using Points = std::vector<std::array<double, 3>>;

std::vector<Vec3> vectors_of(const Points& points) {
  std::vector<Vec3> vectors;
  for (const auto& p : points) vectors.push_back({p[0], p[1], p[2]});
  return vectors;
}

pde::EdgeSettings edges_of(const Volume<float>& image, double smoothing_mm, double edge_per_mm) {
  return {smoothing_mm, edge_per_mm > 0 ? edge_per_mm : pde::default_edge_per_mm(image, smoothing_mm)};
}

py::tuple contour(const Array<float>& array, const Geometry& g, const Points& seeds, double radius_mm,
                  const std::string& model, double curvature_mm, double attraction_mm, double balloon,
                  double smoothing_mm, double edge_per_mm, int max_iterations) {
  if (model != "geodesic" && model != "geometric")
    throw UserError("unknown \"" + model + "\"", "model", "give \"geodesic\" or \"geometric\"");
  pde::ContourSettings settings;
  settings.model = model == "geodesic" ? pde::ContourModel::geodesic : pde::ContourModel::geometric;
  settings.curvature_mm = curvature_mm;
  settings.attraction_mm = attraction_mm;
  settings.balloon = balloon;
  settings.max_iterations = max_iterations;
  const auto image = volume_of(array, g);
  auto found = unlocked([&] {
    return pde::evolve_contour(image, pde::balls(image.grid, vectors_of(seeds), radius_mm),
                               edges_of(image, smoothing_mm, edge_per_mm), settings, parallel::self());
  });
  return py::make_tuple(array_of(std::move(found.level_set)), std::string(pde::name_of(found.end)), found.iterations);
}

py::tuple subjective_surface(const Array<float>& array, const Geometry& g, const Points& seeds, double share,
                             double smoothing_mm, double edge_per_mm, int max_iterations) {
  const auto image = volume_of(array, g);
  const auto points = vectors_of(seeds);
  auto [seen, object] = unlocked([&] {
    auto surface = pde::subjective_surface(image, points, edges_of(image, smoothing_mm, edge_per_mm),
                                           {.max_iterations = max_iterations}, parallel::self());
    auto mask = pde::object_of(surface, points, share);
    return std::pair{std::move(surface), std::move(mask)};
  });
  return py::make_tuple(array_of(std::move(object)), array_of(std::move(seen.surface)), seen.steady);
}

void add_equations(py::module_& m) {
  m.def("filters", &filter_table);
  m.def("apply_filter", [](const std::string& name, const Array<float>& array, const Geometry& g,
                           const std::map<std::string, double>& parameters) {
    const auto image = volume_of(array, g);
    return array_of(unlocked([&] { return pde::apply_filter(name, image, parameters, parallel::self()); }));
  });
  m.def("chan_vese", &chan_vese);
  m.def("segment", &segment);
  m.def("contour", &contour);
  m.def("subjective_surface", &subjective_surface);
  m.def("distance", [](const Array<float>& array, const Geometry& g) {
    const auto level_set = volume_of(array, g);
    return array_of(unlocked([&] { return pde::fast_sweeping(level_set); }));
  });
}

}  // namespace

void add_images(py::module_& m) {
  py::class_<Geometry>(m, "Geometry")
      .def(py::init([](const std::array<double, 3>& spacing, const std::array<double, 3>& origin,
                       const std::array<std::array<double, 3>, 3>& direction) {
        return Geometry{spacing, origin, direction};
      }));
  add_files(m);
  add_equations(m);
  m.def("find_landmarks", [](const Array<std::int16_t>& array, const Geometry& g) {
    auto ct = volume_of(array, g);
    const auto found = unlocked([&] { return find_landmarks(std::move(ct)); });
    return py::make_tuple(write_landmarks(found.landmarks), found.confidence, found.warnings);
  });
  py::list regions;
  for (const auto& row : region_table()) regions.append(py::make_tuple(std::string(row.name), row.tag));
  m.attr("regions") = regions;
}

}  // namespace heartgen::python
