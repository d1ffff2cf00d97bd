// What processes that share one precompute agree upon. Knows nothing of how they talk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace relumine::prt {

/// The most parts of a precompute.
inline constexpr std::uint32_t MaxParts = 1 << 16;

/// One of several parts. Parts take the tiles of VisibleCounts in turn: neighbouring tiles cost
/// about the same, so the parts do, too.
struct Part {
    /// 0 .. count - 1
    std::uint32_t index = 0;
    std::uint32_t count = 1;

    bool operator==(const Part&) const = default;
};

/// Returns elements as the bytes that processes send each other.
template<typename Element>
[[nodiscard]] std::vector<std::byte> to_send(std::span<Element> elements) {
    static_assert(std::is_trivially_copyable_v<Element>);
    const auto bytes = std::as_bytes(elements);
    return {bytes.begin(), bytes.end()};
}

/// Figures of all processes. Integers have the same sum in any order, so each process gets the same
/// result, and it is the same for any number of processes.
///
/// All processes call the same functions in the same order, with spans of the same size, from one
/// thread each. A call waits for the others.
class Reduction {
public:
    Reduction() = default;
    virtual ~Reduction() = default;
    Reduction(const Reduction&) = delete;
    Reduction& operator=(const Reduction&) = delete;

    /// The receivers of this process.
    [[nodiscard]] virtual Part part() const = 0;
    /// Whether there are other processes to wait for.
    [[nodiscard]] virtual bool has_others() const = 0;
    /// Replaces each value by its sum over all processes.
    ///
    /// Throws: where another process has failed.
    virtual void sum(std::span<std::int64_t> values) = 0;
    /// Replaces each value by the largest of all processes. Throws as sum() does.
    virtual void max(std::span<std::int64_t> values) = 0;
    /// Returns the bytes of all processes, by index, in each process. Throws as sum() does.
    [[nodiscard]] virtual std::vector<std::vector<std::byte>>
    all_gather(std::vector<std::byte> bytes) = 0;
};

/// A process that asks no other: it does all of the work, or a part whose clusters are given.
class NoReduction final : public Reduction {
public:
    explicit NoReduction(const Part& part = {}) : part_(part) {}
    [[nodiscard]] Part part() const override { return part_; }
    [[nodiscard]] bool has_others() const override { return false; }
    void sum(std::span<std::int64_t>) override {}
    void max(std::span<std::int64_t>) override {}
    [[nodiscard]] std::vector<std::vector<std::byte>>
    all_gather(std::vector<std::byte> bytes) override {
        return {std::move(bytes)};
    }

private:
    Part part_;
};

} // namespace relumine::prt
