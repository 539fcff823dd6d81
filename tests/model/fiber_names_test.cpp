// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/fiber_names.hpp"

#include <gtest/gtest.h>

namespace heartgen {
namespace {

TEST(FiberNames, AreKnownFromManyPrograms) {
  for (const char* name : {"fiber", "fibre", "fibers", "FIB_DIR", "Fiber_longitudinal", "f0", "e1", "longitudinal",
                           "myocardial_fiber", "lon"})
    EXPECT_EQ(axis_name(name), AxisName::fiber) << name;
  for (const char* name : {"sheet", "sheets", "fiber_sheet", "s0", "e2", "transversal"})
    EXPECT_EQ(axis_name(name), AxisName::sheet) << name;
  for (const char* name : {"sheet_normal", "SheetNormal", "n0", "e3"})
    EXPECT_EQ(axis_name(name), AxisName::sheet_normal) << name;
  for (const char* name : {"Normals", "direction", "displacement", "velocity", "force", ""})
    EXPECT_EQ(axis_name(name), AxisName::none) << name;
}

}  // namespace
}  // namespace heartgen
