// Processes of a shared precompute as threads of one.
#pragma once

#include <algorithm>
#include <barrier>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "prt/team.h"

namespace relumine::prt {

/// What the threads share.
class ThreadTeam {
public:
    explicit ThreadTeam(std::uint32_t count)
        : values_(count), bytes_(count), meeting_(static_cast<std::ptrdiff_t>(count)) {}

    /// Runs work(reduction, index) in one thread for each part. Throws what the first part threw.
    template<typename Work>
    static void run(std::uint32_t count, const Work& work) {
        ThreadTeam team(count);
        std::vector<std::exception_ptr> errors(count);
        std::vector<std::thread> threads;
        for (std::uint32_t i = 0; i < count; ++i)
            threads.emplace_back([&, i] {
                Member member(team, {i, count});
                try {
                    work(member, i);
                } catch (...) {
                    errors[i] = std::current_exception();
                }
            });
        for (std::thread& thread : threads)
            thread.join();
        for (const std::exception_ptr& error : errors)
            if (error)
                std::rethrow_exception(error);
    }

private:
    class Member final : public Team {
    private:
        template<typename Look>
        auto exchange(std::vector<std::byte> bytes, const Look& look) {
            team_.bytes_[part_.index] = std::move(bytes);
            team_.meeting_.arrive_and_wait();
            auto result = look(team_.bytes_);
            team_.meeting_.arrive_and_wait();
            return result;
        }

    public:
        Member(ThreadTeam& team, const Part& part) : team_(team), part_(part) {}
        [[nodiscard]] Part part() const override { return part_; }
        [[nodiscard]] bool has_others() const override { return true; }
        void sum(std::span<std::int64_t> values) override {
            meet(values, [](std::int64_t a, std::int64_t b) { return a + b; });
        }
        void max(std::span<std::int64_t> values) override {
            meet(values, [](std::int64_t a, std::int64_t b) { return std::max(a, b); });
        }

        [[nodiscard]] std::vector<std::vector<std::byte>>
        all_gather(std::vector<std::byte> bytes) override {
            return exchange(std::move(bytes), [](const auto& of_all) { return of_all; });
        }
        [[nodiscard]] std::vector<std::byte> broadcast(std::vector<std::byte> bytes) override {
            return exchange(std::move(bytes), [](const auto& of_all) { return of_all[0]; });
        }
        [[nodiscard]] std::vector<std::vector<std::byte>>
        gather(std::vector<std::byte> bytes) override {
            return exchange(std::move(bytes), [this](const auto& of_all) {
                return part_.index == 0 ? of_all : std::vector<std::vector<std::byte>>();
            });
        }
        [[nodiscard]] std::vector<std::byte>
        scatter(std::vector<std::vector<std::byte>> bytes) override {
            if (part_.index == 0)
                team_.bytes_ = std::move(bytes);
            team_.meeting_.arrive_and_wait();
            std::vector<std::byte> own = team_.bytes_[part_.index];
            team_.meeting_.arrive_and_wait();
            return own;
        }
        [[nodiscard]] double seconds_waiting() const override { return 0.0; }

    private:
        template<typename Combine>
        void meet(std::span<std::int64_t> values, const Combine& combine) {
            team_.values_[part_.index].assign(values.begin(), values.end());
            team_.meeting_.arrive_and_wait();
            std::vector<std::int64_t> result = team_.values_[0];
            bool fits = true;
            for (std::size_t other = 1; other < part_.count; ++other) {
                fits = fits && team_.values_[other].size() == result.size();
                for (std::size_t i = 0; fits && i < result.size(); ++i)
                    result[i] = combine(result[i], team_.values_[other][i]);
            }
            team_.meeting_.arrive_and_wait();
            if (!fits)
                throw std::logic_error("the processes do not agree upon what to add");
            std::copy(result.begin(), result.end(), values.begin());
        }

        ThreadTeam& team_;
        Part part_;
    };

    std::vector<std::vector<std::int64_t>> values_;
    std::vector<std::vector<std::byte>> bytes_;
    std::barrier<> meeting_;
};

} // namespace relumine::prt
