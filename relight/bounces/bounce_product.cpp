#include "relight/bounces/bounce_product.h"

#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

namespace relumine::relight {

namespace {

std::size_t checked_first(const prt::BounceMatrix& matrix, std::size_t num_receivers,
                          const SharedRows& shared) {
    if (matrix.num_rows() != num_receivers)
        throw std::invalid_argument(fmt::format("expected bounces of {} receivers, got {}",
                                                num_receivers, matrix.num_rows()));
    return shared.team != nullptr ? shared.first : prt::first_emitter(matrix);
}

} // namespace

BounceProduct::BounceProduct(const prt::BounceMatrix& matrix, std::size_t num_receivers,
                             const SharedRows& shared)
    : matrix_(matrix), shared_(shared), first_(checked_first(matrix, num_receivers, shared)),
      gathered_(num_receivers) {}

bool BounceProduct::has_emitters() const {
    if (shared_.team == nullptr)
        return !matrix_.emitters.places.empty();
    return std::any_of(shared_.num_emitters.begin(), shared_.num_emitters.end(),
                       [](std::uint32_t number) { return number != 0; });
}

void BounceProduct::multiply(std::span<const PaddedRgb> sent, std::size_t begin, std::size_t end,
                             std::span<PaddedRgb> result) {
    for_rows(begin, end, [&](std::size_t first, std::size_t last) {
        if (is_own(first))
            sum_lists(matrix_.emitters, sent, first, last, gathered_);
    });
    share_gathered(begin, end);
    for_rows(begin, end, [&](std::size_t first, std::size_t last) {
        sum_lists(matrix_.averaged, gathered_, first, last, result);
        for (std::size_t i = first; i < last; ++i)
            for (std::size_t c = 0; c < 4; ++c)
                result[i].rgb[c] *= matrix_.weights[i];
    });
}

/// Whether this process has the run of rows that begins there.
bool BounceProduct::is_own(std::size_t begin) const {
    return shared_.team == nullptr || prt::has_row(shared_.team->part(), begin, first_);
}

/// Gives all processes what each has gathered for its rows.
void BounceProduct::share_gathered(std::size_t begin, std::size_t end) {
    if (shared_.team == nullptr)
        return;
    const prt::Part part = shared_.team->part();
    const auto for_runs = [&](std::uint32_t process, const auto& visit) {
        for (std::size_t run = begin; run < end; run += RowsPerTask)
            if (prt::has_row({process, part.count}, run, first_))
                visit(std::span(gathered_).subspan(run, std::min(RowsPerTask, end - run)));
    };
    std::vector<PaddedRgb> own;
    for_runs(part.index, [&](std::span<const PaddedRgb> run) {
        own.insert(own.end(), run.begin(), run.end());
    });
    const auto bytes = std::as_bytes(std::span(own));
    const auto of_all = shared_.team->all_gather({bytes.begin(), bytes.end()});
    for (std::uint32_t process = 0; process < of_all.size(); ++process) {
        std::size_t at = 0;
        for_runs(process, [&](std::span<PaddedRgb> run) {
            if (of_all[process].size() < at + run.size_bytes())
                throw std::runtime_error("expected the bounces of all processes");
            std::memcpy(run.data(), of_all[process].data() + at, run.size_bytes());
            at += run.size_bytes();
        });
    }
}

} // namespace relumine::relight
