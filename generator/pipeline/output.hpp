// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the program says: standard output, standard error, and the last line before a signal ends it.
#pragma once
#include <string_view>

namespace heartgen::pipeline {

/// To be called first. From then on control characters from files reach neither stream (see printable), and a standard
/// error that cannot be written stops nothing.
void begin_output();

/// Draws on the terminal behind standard error, control characters and all.
void draw(std::string_view text);

/// Writes out what is held back. Returns why not all of standard output could be written; empty where it could.
std::string_view finish_output();

/// SIGHUP, SIGINT and SIGTERM, where they are not ignored, say one line, remove what is unfinished (see
/// model/unfinished.hpp) and end the program with 128 and the signal's number. Before other threads are made.
void watch_signals();

/// Of several ranks one speaks.
void say_nothing_when_stopped();

}  // namespace heartgen::pipeline
