// A scene that stays loaded and answers requests: one JSON object each, docs/serve.md.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace relumine::app {

class Session;

/// Answers requests of `relumine serve`. What they are stands in one table in service.cpp; their
/// members are the options of the command line.
class Service {
public:
    /// No scene is loaded yet. The session must outlive the service.
    explicit Service(Session& session);
    ~Service();
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;

    /// Does what a request asks for and returns the answer, one line of JSON without line break. A
    /// request that fails is answered {"ok": false, "error": "..."}, and the scene stays as it was.
    ///
    /// Throws:  prt::Cancelled when the program is asked to stop meanwhile.
    [[nodiscard]] std::string answer(std::string_view request);

    /// The answer to what is no request.
    [[nodiscard]] static std::string refusal(const std::string& message);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace relumine::app
