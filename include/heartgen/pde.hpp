// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The toolkit for partial differential equations on images (thesis, appendix A), in 2D, in 3D and distributed: the
/// same functions for all three. The four roles of that appendix are played by plain data:
///
/// | role | here |
/// |---|---|
/// | `Image2D` | `Volume<float>` of one slice |
/// | `Image3D` | `Volume<float>` |
/// | `PImage3D`, an image that processes share | `parallel::Slab<float>` with a `parallel::Comm` |
/// | `Mesh3D` | `TetMesh` (meshes.hpp) |
///
/// A slab is the slices that a rank owns, with ghost slices: `parallel::scatter` divides an image, `parallel::gather`
/// brings it together, `parallel::exchange_halo` fills the ghosts, `parallel::for_rows` and `parallel::sum_rows` visit
/// rows with threads. Write a filter of your own with these four and it runs on any number of ranks. One process calls
/// with `parallel::self()`; a program under mpirun makes a `parallel::Environment` first and takes `parallel::world()`.
/// No MPI header is needed.
///
/// Functions with a Comm are collective: all ranks call them in the same order. Results have the same bits for any
/// number of ranks and threads. Lengths are mm; images are finite. Everything throws UserError, on every rank.
#pragma once
#include "generator/parallel/comm.hpp"
#include "generator/parallel/slab.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/pde/active_contours.hpp"
#include "generator/pde/chan_vese.hpp"
#include "generator/pde/chan_vese_flow.hpp"
#include "generator/pde/continuous_min_cut.hpp"
#include "generator/pde/diffusion.hpp"
#include "generator/pde/edge_function.hpp"
#include "generator/pde/fast_sweeping.hpp"
#include "generator/pde/filters.hpp"
#include "generator/pde/hierarchy.hpp"
#include "generator/pde/level_set_motion.hpp"
#include "generator/pde/median.hpp"
#include "generator/pde/redistance.hpp"
#include "generator/pde/snake.hpp"
#include "generator/pde/sobolev.hpp"
#include "generator/pde/subjective_surface.hpp"
#include "generator/pde/total_variation.hpp"
#include "model/error.hpp"
