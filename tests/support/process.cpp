#include "tests/support/process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <set>
#include <thread>

#include "tests/support/check.h"
#include "tests/support/scratch.h"

namespace sidestep::test {
namespace {

std::set<int>& living() {
  static std::set<int> ids;
  return ids;
}

int started = 0;

}  // namespace

Process::Process(const std::vector<std::string>& arguments)
    : log_file_(scratch_file("process-" + std::to_string(++started) + ".log", "")) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const int parent = getpid();
  id_ = fork();
  check(id_ >= 0, "cannot fork");
  if (id_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int signal : {SIGHUP, SIGINT}) std::signal(signal, SIG_DFL);  // nohup and shells ignore them
    if (getppid() != parent) _exit(127);
    const int log = open(log_file_.c_str(), O_WRONLY | O_APPEND);
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  living().insert(id_);
}

Process::~Process() {
  if (code_ != kStillRunning) return;
  kill(id_, SIGKILL);
  wait(5.0);
}

void Process::signal(int number) {
  if (code_ == kStillRunning) kill(id_, number);
}

int Process::wait(double limit_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
  while (code_ == kStillRunning) {
    int status = 0;
    if (waitpid(id_, &status, WNOHANG) == id_) {
      code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
      living().erase(id_);
    } else if (std::chrono::steady_clock::now() > end) {
      break;
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  return code_;
}

std::string Process::output() const {
  return text_of(log_file_);
}

double patient_s(double limit_s) {
  return std::getenv("UNTIMED") ? 10.0 * limit_s : limit_s;
}

int kill_processes(void**) {
  for (const int id : living()) {
    kill(id, SIGKILL);
    waitpid(id, nullptr, 0);
  }
  living().clear();
  return 0;
}

}  // namespace sidestep::test
