// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/behind_wall.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "model/error.hpp"
#include "model/memory.hpp"

namespace heartgen::adapters {
namespace {

#ifdef __has_feature
constexpr bool is_sanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool is_sanitized = true;  // needs terabytes of addresses, and must be heard
#else
constexpr bool is_sanitized = false;
#endif

/// The child ended before it said all.
struct Ended {};
/// It said nothing for longer than it may.
struct Late {};
/// It sends more than the memory can hold.
struct TooMuch {};

/// Addresses that this process has, in bytes.
double present_bytes() {
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  file >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

rlim_t limit_of(double amount) {
  return amount < static_cast<double>(std::numeric_limits<rlim_t>::max() / 2) ? static_cast<rlim_t>(amount)
                                                                              : RLIM_INFINITY;
}

void set_limit(decltype(RLIMIT_AS) resource, double amount) {
  rlimit limit{};
  getrlimit(resource, &limit);
  limit.rlim_cur = std::min(limit_of(amount), limit.rlim_max);
  setrlimit(resource, &limit);
}

bool is_child = false;

/// What the child inherits and must not use: the terminal, the program's way with signals and its end.
void close_off(const Allowance& allowance) {
  is_child = true;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  constexpr int last_signal = 31;
  for (int signal = 1; signal <= last_signal; ++signal) std::signal(signal, SIG_DFL);
  std::atexit([] { _exit(1); });  // a library that calls exit() must not run what this process has to do at its end
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (!is_sanitized) dup2(nowhere, stream);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_CPU, std::ceil(allowance.seconds));
  if (!is_sanitized) set_limit(RLIMIT_AS, present_bytes() + allowance.memory_bytes);
}

void send_refusal(WallSender& sender, const UserError& error) {
  sender.put(false);
  sender.put(error.problem);
  sender.put(error.where);
  sender.put(error.remedy);
}

[[noreturn]] void live_in_child(int pipe, const std::string& path, const Allowance& allowance,
                                const std::function<void(WallSender&)>& work) {
  close_off(allowance);
  WallSender sender(pipe);
  try {
    try {
      work(sender);
    } catch (const UserError& error) {
      send_refusal(sender, error);
    } catch (const std::bad_alloc&) {
      send_refusal(sender, {"asks for more memory than its size allows for", path, "is it complete and undamaged?"});
    } catch (const std::exception& error) {
      send_refusal(sender,
                   {fmt::format("cannot be read: {}", one_line(error.what())), path, "is it complete and undamaged?"});
    }
  } catch (...) {
    _exit(1);
  }
  _exit(0);
}

/// A pipe with a child behind it; whoever leaves early ends the child.
struct Child {
  pid_t id = -1;
  int pipe = -1;

  Child(const std::string& path, const Allowance& allowance, const std::function<void(WallSender&)>& work) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw UserError("no pipe for its reader", path, "end other programs");
    fcntl(ends[1], F_SETPIPE_SZ, 1 << 20);  // fewer turns; without it, it is slower
    id = fork();
    if (id == 0) live_in_child(ends[1], path, allowance, work);
    close(ends[1]);
    pipe = ends[0];
    if (id < 0) {
      close(pipe);
      throw UserError("no process for its reader", path, "end other programs");
    }
  }
  ~Child() {
    if (id > 0) {
      kill(id, SIGKILL);
      wait();
    }
    close(pipe);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  int wait() {
    int status = 0;
    while (waitpid(id, &status, 0) < 0 && errno == EINTR) {
    }
    id = -1;
    return status;
  }
};

void receive_result(WallReceiver& receiver, const std::function<void(WallReceiver&)>& receive) {
  bool is_result = false;
  receiver.get(is_result);
  if (is_result) return receive(receiver);
  std::string problem, where, remedy;
  for (auto* text : {&problem, &where, &remedy}) receiver.get(*text);
  throw UserError(problem, where, remedy);
}

UserError why_it_ended(int status, const std::string& path, const Allowance& allowance) {
  const char* remedy = "is it complete and undamaged?";
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    return {fmt::format("cannot be read within {:.0f} s", allowance.seconds), path, remedy};
  return {"cannot be read: the library for its format fails at it", path, remedy};
}

}  // namespace

std::string one_line(std::string text) {
  for (char& c : text)
    if (c < ' ' || c > '~') c = static_cast<unsigned char>(c) < ' ' ? ' ' : '?';
  return text;
}

Allowance allowance_for(double file_bytes, double held_bytes) {
  constexpr double base_bytes = 512 << 20, base_s = 20, bytes_per_s = 1e6;
  const double wanted = base_bytes + 3 * (file_bytes + held_bytes), there = memory_bytes();
  return {there > 0 ? std::min(wanted, there) : wanted, base_s + (file_bytes + held_bytes) / bytes_per_s};
}

void allow_memory(double more_bytes) {
  if (is_child && !is_sanitized) set_limit(RLIMIT_AS, present_bytes() + more_bytes);
}

void WallSender::raw(const void* data, std::size_t size) {
  for (const char* from = static_cast<const char*>(data); size > 0;) {
    const auto sent = write(pipe, from, size);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) _exit(1);  // nobody listens
    from += sent;
    size -= static_cast<std::size_t>(sent);
  }
}

WallReceiver::WallReceiver(int pipe_, double patience_s_)
    : pipe(pipe_), left_bytes(memory_bytes()), patience_s(patience_s_) {
  if (left_bytes == 0) left_bytes = std::numeric_limits<double>::infinity();
}

void WallReceiver::require(std::size_t size) const {
  if (static_cast<double>(size) > left_bytes) throw TooMuch{};
}

void WallReceiver::raw(void* data, std::size_t size) {
  require(size);
  left_bytes -= static_cast<double>(size);
  for (char* to = static_cast<char*>(data); size > 0;) {
    pollfd waiting{pipe, POLLIN, 0};
    // In slices, so that the time for which both processes are stopped does not count.
    for (double silent_s = 0; poll(&waiting, 1, 1000) == 0;)
      if (++silent_s > patience_s) throw Late{};
    const auto got = read(pipe, to, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw Ended{};
    to += got;
    size -= static_cast<std::size_t>(got);
  }
}

void behind_wall(const std::string& path, const Allowance& allowance, const std::function<void(WallSender&)>& work,
                 const std::function<void(WallReceiver&)>& receive) {
  Child child(path, allowance, work);
  WallReceiver receiver(child.pipe, allowance.seconds);
  try {
    receive_result(receiver, receive);
  } catch (const Ended&) {
    throw why_it_ended(child.wait(), path, allowance);
  } catch (const Late&) {
    throw UserError(fmt::format("cannot be read within {:.0f} s", allowance.seconds), path,
                    "is it complete and undamaged?");
  } catch (const TooMuch&) {
    throw UserError("holds more than this machine's memory", path, "is it complete and undamaged?");
  }
}

}  // namespace heartgen::adapters
