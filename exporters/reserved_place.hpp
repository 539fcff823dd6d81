// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The place where a bundle will stand, kept for one run while it makes the bundle.
#pragma once
#include <filesystem>
#include <memory>
#include <string>

namespace heartgen::exporters {

enum class Existing { refuse, replace };

/// Held by one run at a time: other runs, also of other programs, are refused the same folder meanwhile.
struct ReservedPlace {
  std::filesystem::path folder;   ///< where the bundle will stand; absolute, without a trailing slash
  std::filesystem::path partial;  ///< empty sibling folder in which it is prepared
  std::string remark;             ///< what a killed run had left and was put right, for the user; mostly empty
  std::shared_ptr<void> claim;    ///< with the last copy of it goes the lock, and `partial` where it still is
};

/// To be called before the work whose result comes there. A bundle that a killed run left beside its place, as
/// ".NAME.old", is put back. Throws UserError when `folder` exists and is not a bundle, or is one and `existing` is
/// refuse, when it holds what was not written with the bundle, when nothing can be written beside it, or when another
/// run holds the place.
ReservedPlace reserve_place(const std::filesystem::path& folder, Existing existing);

/// Puts `place.partial` at `place.folder` in one step where the file system can; an older bundle there is removed after
/// that. Throws UserError as reserve_place does: what stands there may have changed.
void move_into_place(const ReservedPlace& place, Existing existing);

}  // namespace heartgen::exporters
