// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What programs call the arrays that hold fibre, sheet and sheet-normal axes.
#pragma once
#include <string_view>

namespace heartgen {

enum class AxisName { none, fiber, sheet, sheet_normal };

/// fiber: fib..., ...fiber..., f0, e1, longitudinal ...; sheet: ...sheet..., s0, e2, transversal ...; sheet_normal:
/// both "sheet" and "normal", n0, e3. Small and capital letters are the same.
AxisName axis_name(std::string_view array);

}  // namespace heartgen
