// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/palette.hpp"

#include <array>

namespace heartgen::report {
namespace {

constexpr Rgb unknown_color{150, 150, 150};

// By region tag. Walls are warm, left blood red, right blood blue, everything around the heart is quiet.
constexpr std::array<Rgb, 20> region_colors = {{
    {0, 0, 0},        // none
    {226, 98, 76},    // lv_myocardium
    {240, 163, 78},   // rv_myocardium
    {176, 58, 104},   // papillary
    {233, 136, 152},  // la_wall
    {199, 155, 205},  // ra_wall
    {206, 38, 54},    // lv_blood
    {62, 116, 204},   // rv_blood
    {238, 78, 120},   // la_blood
    {84, 166, 222},   // ra_blood
    {248, 208, 74},   // aorta
    {60, 186, 178},   // pulmonary_artery
    {148, 178, 200},  // lung
    {222, 212, 184},  // bone
    {146, 104, 76},   // liver
    {126, 204, 126},  // trachea
    {178, 96, 216},   // carotid
    {196, 168, 150},  // torso
    {232, 226, 206},  // la_annulus
    {218, 214, 226},  // ra_annulus
}};

constexpr std::array<Rgb, 12> cycle = {{{226, 98, 76},
                                        {62, 116, 204},
                                        {240, 178, 78},
                                        {84, 176, 132},
                                        {176, 58, 104},
                                        {120, 186, 222},
                                        {199, 155, 205},
                                        {148, 170, 82},
                                        {238, 130, 150},
                                        {60, 160, 168},
                                        {178, 128, 92},
                                        {136, 112, 208}}};

}  // namespace

Rgb region_color(std::int32_t region) {
  return region >= 0 && region < static_cast<std::int32_t>(region_colors.size())
             ? region_colors[static_cast<std::size_t>(region)]
             : unknown_color;
}

Rgb surface_color(std::int32_t surface) {
  return surface > 0 ? cycle[static_cast<std::size_t>(surface - 1) % cycle.size()] : unknown_color;
}

}  // namespace heartgen::report
