// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Foreign readers in a process of their own. A file that makes a library write where it may not, divide by zero, ask
/// for all memory or run for ever ends that process, not this one, and becomes a UserError. Nothing that the library
/// prints is seen. What it read comes back through a pipe, so that nothing is held twice and no file is made.
#pragma once
#include <functional>
#include <string>

#include "model/archive.hpp"

namespace heartgen::adapters {

/// Text out of a file or a library as part of a message: no control characters, ASCII alone.
std::string one_line(std::string text);

/// What a reader may take, beyond the memory that this process has when it starts.
struct Allowance {
  double memory_bytes = 0;
  double seconds = 0;  ///< of processor time; and of silence, while nothing comes back
};

/// Enough for any library to read a file of that size, compressed or not, whose contents take `held_bytes` in memory.
Allowance allowance_for(double file_bytes, double held_bytes);

/// Raises the memory of the reader that calls it, once it knows what its file holds. Does nothing elsewhere.
void allow_memory(double more_bytes);

/// The child's end of the pipe.
struct WallSender : Packing<WallSender> {
  int pipe;
  explicit WallSender(int pipe_) : pipe(pipe_) {}
  void raw(const void* data, std::size_t size);
};

/// This process's end. Trusts no count that the memory could not hold.
struct WallReceiver : Unpacking<WallReceiver> {
  int pipe;
  double left_bytes;
  double patience_s;
  WallReceiver(int pipe_, double patience_s_);
  void require(std::size_t size) const;
  void raw(void* data, std::size_t size);
};

/// Runs `work` in a child, on one thread, and `receive` here. Throws the UserError that `work` throws, or one that
/// names `path` where the child ends in another way or takes more than it is allowed.
void behind_wall(const std::string& path, const Allowance& allowance, const std::function<void(WallSender&)>& work,
                 const std::function<void(WallReceiver&)>& receive);

/// What `read` returns in a child. T has `members`, or is plain.
template <class T, class Read>
T read_behind_wall(const std::string& path, const Allowance& allowance, const Read& read) {
  T result{};
  behind_wall(
      path, allowance,
      [&](WallSender& sender) {
        const T value = read();
        sender.put(true);
        sender.put(value);
      },
      [&](WallReceiver& receiver) { receiver.get(result); });
  return result;
}

}  // namespace heartgen::adapters
