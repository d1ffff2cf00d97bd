#include "app/command_line/printed.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <stdexcept>

namespace relumine::app {

void print(const std::string& text) {
    static std::atomic<bool> is_unread = false;
    if (is_unread)
        return;
    // Flushed each time: a full disk shows only then, and whoever reads along need not wait.
    if (std::fputs(text.c_str(), stdout) != EOF && std::fflush(stdout) == 0)
        return;
    if (errno != EPIPE)
        throw std::runtime_error("cannot write to standard output");
    is_unread = true;
}

} // namespace relumine::app
