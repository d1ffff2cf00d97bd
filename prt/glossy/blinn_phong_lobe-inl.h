// The highlight of blinn_phong_lobe.h, 16 receivers at a time. A part of lobe_kernel.cpp.

inline Vector specular(BlinnPhongLobe, const LobeTerms& terms) {
    const Tag d;
    // log1p keeps digits that 1 - sin^2 would round away.
    const auto sin2 = hn::Min(terms.sin2, hn::Set(d, 1.0f - 6e-8f));
    const auto log_cos = hn::Mul(hn::Set(d, 0.5f), hn::Log1p(d, hn::Neg(sin2)));
    const auto power = hn::Exp(d, hn::Mul(terms.parameter(0), log_cos));
    return hn::Mul(hn::Mul(terms.parameter(1), power), terms.n_w);
}
