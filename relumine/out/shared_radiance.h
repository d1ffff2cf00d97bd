// Radiance that other threads look at.
#pragma once

#include <mutex>
#include <shared_mutex>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine {

/// Keeps the radiance of a LitScene for other threads, while one edits it.
///
/// Threads: one publishes at a time. Any may ask for a snapshot at any moment; it never shows half
///          an update.
class SharedRadiance {
public:
    void publish(std::span<const glm::vec3> radiance) {
        back_.assign(radiance.begin(), radiance.end());
        const std::unique_lock lock(mutex_);
        std::swap(front_, back_);
    }
    /// Returns what was published last; empty before.
    [[nodiscard]] std::vector<glm::vec3> snapshot() const {
        const std::shared_lock lock(mutex_);
        return front_;
    }

private:
    mutable std::shared_mutex mutex_;
    std::vector<glm::vec3> front_;
    /// Filled without the lock, then swapped in.
    std::vector<glm::vec3> back_;
};

} // namespace relumine
