// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <thread>

#include "model/printable.hpp"
#include "model/unfinished.hpp"

namespace heartgen::pipeline {
namespace {

// What went wrong first with standard output; 0: nothing.
std::atomic<int> output_error = 0;

/// All of it, or `errno`.
int write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const auto written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno != EINTR) return errno;
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

// The streams never see an error: standard output's is kept here and told at the end, and then nothing more is written.
ssize_t write_output(void*, const char* text, std::size_t size) {
  if (output_error == 0) output_error = write_all(STDOUT_FILENO, printable({text, size}));
  return static_cast<ssize_t>(size);
}

ssize_t write_error(void*, const char* text, std::size_t size) {
  write_all(STDERR_FILENO, printable({text, size}));
  return static_cast<ssize_t>(size);
}

/// A stream that was closed gets no file of ours: it is opened so that writing fails, as it should.
void open_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

/// std::cout, by which the command line's parser prints its help.
class OutputBuffer : public std::streambuf {
  int_type overflow(int_type c) override {
    return traits_type::eq_int_type(c, traits_type::eof()) ? traits_type::not_eof(c) : std::putchar(c);
  }
  int sync() override { return std::fflush(stdout); }
};

constexpr std::array<std::pair<int, const char*>, 3> signals = {
    {{SIGHUP, "SIGHUP"}, {SIGINT, "SIGINT"}, {SIGTERM, "SIGTERM"}}};

int signal_pipe[2] = {-1, -1};
std::atomic<bool> speaks = true;

void pass_on(int number) {
  const int before = errno;
  const auto byte = static_cast<char>(number);
  static_cast<void>(!::write(signal_pipe[1], &byte, 1));
  errno = before;
}

[[noreturn]] void stop(int number) {
  std::string line = isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "";
  for (const auto& [known, name] : signals)
    if (known == number) line += std::string("heartgen: stopped by ") + name + ", nothing half-written is left\n";
  remove_unfinished();
  if (speaks) write_all(STDERR_FILENO, line);
  _exit(128 + number);
}

}  // namespace

void begin_output() {
  open_closed_streams();
  constexpr std::size_t block = 1 << 16;
  static auto* const buffer = new OutputBuffer;  // std::cout is flushed after everything else is gone
  const bool is_terminal = isatty(STDOUT_FILENO) == 1;
  std::FILE* const output = fopencookie(nullptr, "w", {nullptr, &write_output, nullptr, nullptr});
  std::FILE* const error = fopencookie(nullptr, "w", {nullptr, &write_error, nullptr, nullptr});
  if (output == nullptr || error == nullptr) return;
  std::setvbuf(output, nullptr, is_terminal ? _IOLBF : _IOFBF, block);
  std::setvbuf(error, nullptr, _IOLBF, block);
  stdout = output;
  stderr = error;
  std::cout.rdbuf(buffer);
}

void draw(std::string_view text) { write_all(STDERR_FILENO, text); }

std::string_view finish_output() {
  std::cout.flush();
  std::fflush(stdout);
  std::fflush(stderr);
  return output_error == 0 ? "" : std::strerror(output_error);
}

void watch_signals() {
  if (pipe2(signal_pipe, O_CLOEXEC) != 0) return;
  std::thread([] {
    char number = 0;
    while (::read(signal_pipe[0], &number, 1) != 1) continue;
    stop(number);
  }).detach();
  for (const auto& [number, name] : signals) {
    struct sigaction now {};
    if (sigaction(number, nullptr, &now) != 0 || now.sa_handler != SIG_DFL) continue;
    now.sa_handler = &pass_on;
    now.sa_flags = SA_RESTART;
    sigaction(number, &now, nullptr);
  }
}

void say_nothing_when_stopped() { speaks = false; }

}  // namespace heartgen::pipeline
