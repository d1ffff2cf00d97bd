// The highlight of ggx_lobe.h, 16 receivers at a time. A part of lobe_kernel.cpp.

/// Returns D V n.w of glTF 2.0, Appendix B.
inline Vector specular(GgxLobe, const LobeTerms& terms) {
    const Tag d;
    const auto one = hn::Set(d, 1.0f);
    const auto a2 = terms.parameter(0);
    const auto n_v = terms.n_v();
    // cos^2 (a2 - 1) + 1 = sin^2 + cos^2 a2
    const auto cos2 = hn::Max(hn::Sub(one, terms.sin2), hn::Zero(d));
    const auto t = hn::MulAdd(cos2, a2, terms.sin2);
    const auto distribution =
        hn::Div(a2, hn::Mul(hn::Set(d, std::numbers::pi_v<float>), hn::Mul(t, t)));
    const auto rest = hn::Sub(one, a2);
    const auto mask_v = hn::Mul(terms.n_w, hn::Sqrt(hn::MulAdd(hn::Mul(n_v, n_v), rest, a2)));
    const auto mask_w = hn::Mul(n_v, hn::Sqrt(hn::MulAdd(hn::Mul(terms.n_w, terms.n_w), rest, a2)));
    const auto visibility = hn::Div(hn::Mul(hn::Set(d, 0.5f), terms.n_w), hn::Add(mask_v, mask_w));
    return hn::Mul(distribution, visibility);
}
