// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Debian's ITK knows GCC alone, by this one header of macros: clang reads it under that name.
#pragma once
#pragma push_macro("__clang__")
#pragma push_macro("__GNUC__")
#undef __clang__
#undef __GNUC__
#define __GNUC__ 12
#include <itk_compiler_detection.h>
#pragma pop_macro("__GNUC__")
#pragma pop_macro("__clang__")
