// Lines of text in, lines of text out: over stdin and stdout, or over a Unix socket.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>

#include "files/descriptor.h"

namespace relumine::app {

/// Who answers.
struct LineService {
    /// Returns the answer to one line; neither has its line break. An exception ends the server.
    std::function<std::string(std::string_view line)> answer;
    /// Returns the answer to what is no line.
    std::function<std::string(const std::string& message)> refuse;
    /// Longer lines are refused. They are not kept in memory.
    std::size_t max_line_bytes = std::size_t{16} << 20;
};

/// Answers the lines of stdin on stdout, until stdin ends, nobody reads stdout, or `stop`.
void serve_standard_streams(const LineService& service, const std::stop_token& stop);

/// A Unix socket of the file system, which only its owner may open (mode 0600 from the start). A
/// socket that a killed program left behind is replaced. The destructor removes the socket.
class LineSocket {
public:
    /// Throws:  std::runtime_error "path: expected X, got Y" for a path that is too long, that
    ///          another program serves, or that is something else than a socket.
    explicit LineSocket(const std::filesystem::path& path);
    ~LineSocket();
    LineSocket(const LineSocket&) = delete;
    LineSocket& operator=(const LineSocket&) = delete;

    /// Answers the lines of all programs that connect, one line at a time, until `stop`. A program
    /// that goes away, or does not read its answers, holds up none of the others.
    ///
    /// Memory:  for each of at most 64 programs a line and an answer.
    void serve(const LineService& service, const std::stop_token& stop);

private:
    std::filesystem::path path_;
    files::Descriptor lock_;
    files::Descriptor listener_;
    /// Device and inode of the socket's name, so that no other is removed.
    unsigned long long device_ = 0, inode_ = 0;
};

} // namespace relumine::app
