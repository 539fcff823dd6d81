// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A certificate on the terminal.
#pragma once
#include "model/certificate.hpp"

namespace heartgen::pipeline {

void print_row(const ReportRow& row);

/// Rows that failed or warned (every row where `all_rows`), then how many of those that judge passed.
void print_rows(const Report& report, bool all_rows);

/// The same, then the table of uses, the warnings and the verdict in one line.
void print_certificate(const Certificate& certificate, bool all_rows);

/// Warnings and doubts on standard error, while a build goes on.
void print_warnings(const std::vector<Warning>& warnings);

/// Uses and warnings as they stand in a bundle.
void print_trust(const std::vector<UseVerdict>& uses, const std::vector<Warning>& warnings);

}  // namespace heartgen::pipeline
