// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/vtk_guard.hpp"

#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <mutex>
#include <new>

#include "model/error.hpp"

namespace heartgen::adapters {
namespace {

/// Takes what VTK would print to the terminal.
class CapturingWindow : public vtkOutputWindow {
 public:
  static CapturingWindow* New();
  void DisplayText(const char* text) override { first_message(text); }
  void DisplayErrorText(const char* text) override { first_message(text); }
  void DisplayGenericWarningText(const char* text) override { first_message(text); }
  void DisplayWarningText(const char*) override {}
  void DisplayDebugText(const char*) override {}
  std::string message;  ///< the first error; the ones after it are usually its consequences

 private:
  void first_message(const char* text) {
    if (message.empty()) message = text;
  }
};
vtkStandardNewMacro(CapturingWindow);

/// While it lives, VTK prints nothing. VTK has one output window per process, hence the lock.
class MessageCapture {
 public:
  MessageCapture() : lock_(mutex()), previous_(vtkOutputWindow::GetInstance()) {
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    vtkOutputWindow::SetInstance(window_);
  }
  ~MessageCapture() { vtkOutputWindow::SetInstance(previous_); }
  MessageCapture(const MessageCapture&) = delete;
  MessageCapture& operator=(const MessageCapture&) = delete;

  /// "Error reading ascii data!" out of "ERROR: In file.cxx, line 1\nvtkReader (0x1): Error reading ascii data!\n"
  std::string text() const {
    std::string message = window_->message;
    if (const auto object_end = message.find("): "); object_end != std::string::npos) message.erase(0, object_end + 3);
    std::replace(message.begin(), message.end(), '\n', ' ');
    const auto last = message.find_last_not_of(' ');
    return last == std::string::npos ? "" : message.substr(0, last + 1);
  }

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  std::lock_guard<std::mutex> lock_;
  vtkSmartPointer<vtkOutputWindow> previous_;
  vtkNew<CapturingWindow> window_;
};

}  // namespace

void run_guarded(const std::filesystem::path& path, const std::string& action, const std::function<bool()>& run) {
  MessageCapture capture;
  bool done = false;
  try {
    done = run();
  } catch (const std::bad_alloc&) {
    throw UserError(action + ": a count in the file asks for more memory than there is", path.string(), "");
  }
  const std::string message = capture.text();
  if (!done || !message.empty())
    throw UserError(action + (message.empty() ? "" : ": " + message), path.string(),
                    "is the file complete, and is there room and right to write?");
}

}  // namespace heartgen::adapters
