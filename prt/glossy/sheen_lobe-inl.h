// The sheen of sheen_lobe.h, 16 receivers at a time. A part of lobe_kernel.cpp.

/// Returns x^p for x above 0.
inline Vector power(Vector x, Vector p) {
    return hn::Exp(Tag(), hn::Mul(p, hn::Log(Tag(), x)));
}

/// Lambda of a cosine for the fit at t.
inline Vector sheen_lambda(Vector t, Vector cosine) {
    const Tag d;
    const auto between = [&](float rough, float smooth) {
        return hn::MulAdd(t, hn::Set(d, smooth - rough), hn::Set(d, rough));
    };
    const auto l = [&](Vector x) {
        const auto bump = hn::MulAdd(between(3.82987f, 3.32435f),
                                     power(x, between(0.19823f, 0.16801f)), hn::Set(d, 1.0f));
        return hn::Add(hn::Div(between(21.5473f, 25.3245f), bump),
                       hn::MulAdd(between(-1.97760f, -1.27393f), x, between(-4.32054f, -4.85967f)));
    };
    const auto half = hn::Set(d, 0.5f), least = hn::Set(d, SheenLobe::LeastCosine);
    const auto x = hn::Min(hn::Max(cosine, least), hn::Set(d, 1.0f));
    const auto upper =
        hn::NegMulAdd(hn::Set(d, 1.0f), l(hn::Max(hn::Sub(hn::Set(d, 1.0f), x), least)),
                      hn::Mul(hn::Set(d, 2.0f), l(half)));
    return hn::Exp(d, hn::IfThenElse(hn::Lt(x, half), l(x), upper));
}

/// Returns the lobe.
inline Vector value(SheenLobe, const LobeTerms& terms) {
    const Tag d;
    const auto one = hn::Set(d, 1.0f);
    const auto parameter = [&](std::size_t i) {
        return hn::Load(d, terms.surfaces.sheen_parameters[i].data() + terms.lane);
    };
    const auto alpha = hn::Max(parameter(0), hn::Set(d, 5e-3f));
    const auto rest = hn::Sub(one, alpha);
    const auto distribution = power(hn::Min(hn::Max(terms.sin2, hn::Set(d, 1e-12f)), one),
                                    hn::Div(hn::Set(d, 0.5f), alpha));
    return hn::Div(
        hn::Mul(parameter(2), distribution),
        hn::Add(hn::Max(parameter(1), one), sheen_lambda(hn::Mul(rest, rest), terms.n_w)));
}
