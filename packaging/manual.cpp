// SPDX-License-Identifier: GPL-3.0-or-later
// manual FOLDER TETGEN_HELP: writes the pages of the manual and the completion for bash, from what --help is made of.
// TETGEN_HELP is a file with the help of heartgen-tetgen.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <heartgen/version.hpp>
#include <iterator>
#include <string>
#include <vector>

#include "generator/app/options.hpp"
#include "model/error.hpp"
#include "model/text.hpp"

namespace {

using namespace heartgen;
namespace fs = std::filesystem;

/// Text as roff takes it: nothing in it is an instruction.
std::string roff(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n'))
      result += std::string("\\&") + c;
    else
      result += c;
  }
  return result;
}

std::string capital(std::string text) {
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return text;
}

std::string head(const std::string& page, const std::string& what) {
  return fmt::format(".TH {} 1 \"\" \"heartgen {}\" \"heartgen\"\n.SH NAME\n{} \\- {}\n", roff(capital(page)),
                     HEARTGEN_VERSION, roff(page), roff(what));
}

bool is_flag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

/// ".TP" with the names of an option and what stands for its value.
std::string option_entry(const CLI::Option& option) {
  std::string names;
  if (option.get_positional() && option.get_lnames().empty()) {
    names = "\\fI" + roff(option.get_name()) + "\\fR";
  } else {
    for (const auto& name : option.get_snames()) names += "\\fB" + roff("-" + name) + "\\fR, ";
    for (const auto& name : option.get_lnames()) names += "\\fB" + roff("--" + name) + "\\fR, ";
    names.resize(names.size() - 2);
    if (!is_flag(option)) names += " \\fI" + roff(option.get_type_name()) + "\\fR";
  }
  return fmt::format(".TP\n{}\n{}{}\n", names, roff(option.get_description()),
                     option.get_required() ? " (required)" : "");
}

std::string synopsis(const std::string& program, const CLI::App& command) {
  std::string line = fmt::format(".SH SYNOPSIS\n\\fB{}\\fR", roff(program));
  for (const auto* option : command.get_options())
    if (option->get_positional() && option->get_lnames().empty())
      line += fmt::format("{}\\fI{}\\fR{}", option->get_required() ? " " : " [", roff(option->get_name()),
                          option->get_required() ? "" : "]");
  return line + " [\\fIoptions\\fR]\n";
}

std::string options_section(const CLI::App& command) {
  std::string text = ".SH OPTIONS\n";
  for (const auto* option : command.get_options()) text += option_entry(*option);
  return text;
}

constexpr const char* tail =
    ".SH EXIT STATUS\n0: done. 1: a defect of heartgen. 2: a mistake, or what the machine lacks. 3: a check failed.\n";

std::string command_page(const std::string& program, const CLI::App& command) {
  const auto name = command.get_name();
  std::string text = head(program + "-" + name, command.get_description());
  text += synopsis(program + " " + name, command) + options_section(command);
  if (const auto footer = command.get_footer(); !footer.empty()) text += ".SH NOTES\n.nf\n" + roff(footer) + "\n.fi\n";
  return text + tail +
         fmt::format(".SH SEE ALSO\n\\fB{}\\fR(1), which has the options of every command\n", roff(program));
}

std::string program_page(const std::string& program, const CLI::App& app) {
  const auto what = app.get_description();
  std::string text = head(program, what.substr(what.find(": ") + 2));
  text += fmt::format(".SH SYNOPSIS\n\\fB{}\\fR \\fIcommand\\fR [\\fIoptions\\fR]\n.SH COMMANDS\n", roff(program));
  for (const auto* command : app.get_subcommands({}))
    text += fmt::format(".TP\n\\fB{}\\fR(1)\n{}\n", roff(program + "-" + command->get_name()),
                        roff(command->get_description()));
  return text + options_section(app) + tail;
}

std::string words_of(const CLI::App& command) {
  std::string words;
  for (const auto* option : command.get_options())
    for (const auto& name : option->get_lnames()) words += "--" + name + " ";
  return words;
}

std::string completion(const std::string& program, const CLI::App& app) {
  std::string commands, cases;
  for (const auto* command : app.get_subcommands({})) {
    commands += command->get_name() + " ";
    cases += fmt::format("    {}) words=\"{}\" ;;\n", command->get_name(), words_of(*command));
  }
  return fmt::format(
      "# bash completion for {0}: commands, their options, files\n"
      "_{0}() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} command=\"\" word words\n"
      "  for word in \"${{COMP_WORDS[@]:1:COMP_CWORD-1}}\"; do\n"
      "    [[ $word != -* ]] && {{ command=$word; break; }}\n"
      "  done\n"
      "  case $command in\n"
      "    \"\") words=\"{1}\" ;;\n{2}"
      "  esac\n"
      "  [[ -n $command && $current != -* ]] && return\n"
      "  [[ -n $command ]] && words+=\"{3}\"\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
      "}}\n"
      "complete -o default -F _{0} {0}\n",
      program, commands + words_of(app), cases, words_of(app));
}

std::string tetgen_page(const std::string& help_file) {
  std::ifstream in(help_file);
  const std::string help{std::istreambuf_iterator<char>(in), {}};
  const auto line = help.substr(0, help.find('\n'));
  return head("heartgen-tetgen", line.substr(line.find(": ") + 2)) + ".SH DESCRIPTION\n.nf\n" +
         roff(help.substr(line.size() + 1)) + ".fi\n.SH SEE ALSO\n\\fBheartgen\\fR(1)\n";
}

void write_manual(const fs::path& folder, const std::string& tetgen_help) {
  const std::string name = "heartgen";
  command_line::CommandLine line(app::description);
  app::Program program{line};
  app::add_commands(program);
  command_line::add_machine_options(line, line.app);
  write_text(folder / "man" / (name + ".1"), program_page(name, line.app));
  write_text(folder / "man" / "heartgen-tetgen.1", tetgen_page(tetgen_help));
  for (const auto* command : line.app.get_subcommands({}))
    write_text(folder / "man" / fmt::format("{}-{}.1", name, command->get_name()), command_page(name, *command));
  write_text(folder / "completions" / name, completion(name, line.app));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    write_manual(argv[1], argv[2]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
