// Based on: Lawson, Hanson, "Solving Least Squares Problems", 1974, chapter 23 (algorithm NNLS), in
//           terms of A^T A and A^T b.
#include "relight/light_fit/non_negative_fit.h"

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace relumine::relight {

namespace {

// Added to the diagonal, relative to it. So columns that repeat each other share the weight, and no
// division by zero occurs.
constexpr double Ridge = 1e-9;

// A slope below this part of its target is zero: rounding of sums of a few thousand products.
constexpr double FlatSlope = 1e-9;

class Fit {
public:
    Fit(std::span<const double> gram, std::span<const double> target, std::span<double> x)
        : gram_(gram.data(), static_cast<Eigen::Index>(x.size()),
                static_cast<Eigen::Index>(x.size())),
          target_(target.data(), static_cast<Eigen::Index>(x.size())), x_(x) {
        for (std::size_t i = 0; i < x.size(); ++i)
            if (x[i] > 0.0)
                positive_.push_back(static_cast<Eigen::Index>(i));
    }

    void solve() {
        fit_positive();
        // Each round lowers the error, so no set of positive unknowns comes twice. The bound is for
        // rounding.
        for (std::size_t round = 0; round < 3 * x_.size() && add_steepest(); ++round)
            fit_positive();
    }

private:
    /// Finds the minimum over the positive unknowns. An unknown that would be negative becomes zero
    /// on the way.
    void fit_positive() {
        while (!positive_.empty()) {
            const Eigen::VectorXd wanted = unconstrained();
            double step = 1.0;
            for (Eigen::Index k = 0; k < wanted.size(); ++k)
                if (wanted[k] <= 0.0)
                    step = std::min(step, at(k) / (at(k) - wanted[k]));
            for (Eigen::Index k = 0; k < wanted.size(); ++k)
                at(k) = step == 1.0 ? wanted[k] : at(k) + step * (wanted[k] - at(k));
            if (step == 1.0)
                return;
            drop_zeros(wanted);
        }
    }

    [[nodiscard]] Eigen::VectorXd unconstrained() const {
        const auto n = static_cast<Eigen::Index>(positive_.size());
        Eigen::MatrixXd gram(n, n);
        Eigen::VectorXd target(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            for (Eigen::Index j = 0; j < n; ++j)
                gram(i, j) = gram_(positive_[static_cast<std::size_t>(i)],
                                   positive_[static_cast<std::size_t>(j)]);
            gram(i, i) *= 1.0 + Ridge;
            target[i] = target_[positive_[static_cast<std::size_t>(i)]];
        }
        return gram.llt().solve(target);
    }

    /// Drops the unknowns that the last step brought to zero.
    void drop_zeros(const Eigen::VectorXd& wanted) {
        std::vector<Eigen::Index> kept;
        for (Eigen::Index k = 0; k < wanted.size(); ++k) {
            constexpr double Zero = 1e-14;
            if (wanted[k] <= 0.0 && at(k) <= Zero * -wanted[k])
                at(k) = 0.0;
            else
                kept.push_back(positive_[static_cast<std::size_t>(k)]);
        }
        positive_ = std::move(kept);
    }

    /// Makes positive the zero unknown along which the error falls fastest. Returns false where it
    /// falls along none.
    bool add_steepest() {
        Eigen::Index steepest = -1;
        double best = 0.0;
        for (Eigen::Index i = 0; i < target_.size(); ++i) {
            if (x_[static_cast<std::size_t>(i)] > 0.0 || gram_(i, i) <= 0.0)
                continue;
            double slope = target_[i];
            for (const Eigen::Index j : positive_)
                slope -= gram_(i, j) * x_[static_cast<std::size_t>(j)];
            if (slope > FlatSlope * target_[i] && slope * slope / gram_(i, i) > best) {
                best = slope * slope / gram_(i, i);
                steepest = i;
            }
        }
        if (steepest < 0 ||
            std::find(positive_.begin(), positive_.end(), steepest) != positive_.end())
            return false;
        positive_.insert(std::upper_bound(positive_.begin(), positive_.end(), steepest), steepest);
        return true;
    }

    double& at(Eigen::Index k) {
        return x_[static_cast<std::size_t>(positive_[static_cast<std::size_t>(k)])];
    }

    Eigen::Map<const Eigen::MatrixXd> gram_;
    Eigen::Map<const Eigen::VectorXd> target_;
    std::span<double> x_;
    /// Ascending.
    std::vector<Eigen::Index> positive_;
};

} // namespace

void fit_non_negative(std::span<const double> gram, std::span<const double> target,
                      std::span<double> x) {
    Fit(gram, target, x).solve();
}

} // namespace relumine::relight
