// Vectors of two doubles for WebAssembly, which Highway 1.0.3 lacks there: the operations that the
// kernels use. Nothing on other processors. Compiled once per instruction set.
#if defined(RELUMINE_FILES_WASM_DOUBLES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_FILES_WASM_DOUBLES_INL_H
#undef RELUMINE_FILES_WASM_DOUBLES_INL_H
#else
#define RELUMINE_FILES_WASM_DOUBLES_INL_H
#endif

#include <cstddef>

#include <hwy/highway.h>

#if HWY_TARGET == HWY_WASM && !HWY_HAVE_FLOAT64
HWY_BEFORE_NAMESPACE();
namespace hwy::HWY_NAMESPACE {

template<std::size_t N>
HWY_API Vec128<double, N> Set(Simd<double, N, 0>, const double value) {
    return {wasm_f64x2_splat(value)};
}
template<std::size_t N>
HWY_API Vec128<double, N> operator+(const Vec128<double, N> a, const Vec128<double, N> b) {
    return {wasm_f64x2_add(a.raw, b.raw)};
}
template<std::size_t N>
HWY_API Vec128<double, N> operator*(const Vec128<double, N> a, const Vec128<double, N> b) {
    return {wasm_f64x2_mul(a.raw, b.raw)};
}
template<std::size_t N>
HWY_API Vec128<double, N> Add(const Vec128<double, N> a, const Vec128<double, N> b) {
    return a + b;
}
template<std::size_t N>
HWY_API Vec128<double, N> Mul(const Vec128<double, N> a, const Vec128<double, N> b) {
    return a * b;
}
template<std::size_t N>
HWY_API Vec128<double, N> Sub(const Vec128<double, N> a, const Vec128<double, N> b) {
    return {wasm_f64x2_sub(a.raw, b.raw)};
}
template<std::size_t N>
HWY_API Vec128<double, N> Div(const Vec128<double, N> a, const Vec128<double, N> b) {
    return {wasm_f64x2_div(a.raw, b.raw)};
}
template<std::size_t N>
HWY_API Vec128<double, N> Abs(const Vec128<double, N> v) {
    return {wasm_f64x2_abs(v.raw)};
}
template<std::size_t N>
HWY_API Vec128<double, N> Floor(const Vec128<double, N> v) {
    return {wasm_f64x2_floor(v.raw)};
}
template<std::size_t N>
HWY_API Mask128<double, N> Gt(const Vec128<double, N> a, const Vec128<double, N> b) {
    return {wasm_f64x2_gt(a.raw, b.raw)};
}
template<std::size_t N>
HWY_API Vec128<double, N> Max(const Vec128<double, N> a, const Vec128<double, N> b) {
    return {wasm_f64x2_max(a.raw, b.raw)};
}
template<std::size_t N>
HWY_API Vec128<double, N> Min(const Vec128<double, N> a, const Vec128<double, N> b) {
    return {wasm_f64x2_min(a.raw, b.raw)};
}
/// Rounds twice: there is no fused one.
template<std::size_t N>
HWY_API Vec128<double, N> MulAdd(const Vec128<double, N> a, const Vec128<double, N> b,
                                 const Vec128<double, N> c) {
    return a * b + c;
}
template<std::size_t N>
HWY_API Vec128<double, N> NegMulAdd(const Vec128<double, N> a, const Vec128<double, N> b,
                                    const Vec128<double, N> c) {
    return Sub(c, a * b);
}
template<std::size_t N>
HWY_API Vec128<double, N> PromoteTo(Simd<double, N, 0>, const Vec128<float, N> v) {
    return {wasm_f64x2_promote_low_f32x4(v.raw)};
}
template<std::size_t N>
HWY_API Vec128<float, N> DemoteTo(Simd<float, N, 0>, const Vec128<double, N> v) {
    return {wasm_f32x4_demote_f64x2_zero(v.raw)};
}

} // namespace hwy::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#endif // toggle
