// Stands before TBB's header in builds for the thread sanitizer, which does not see inside Debian's
// TBB. The marks here tell it what TBB promises: what comes before a loop happens before each of
// its parts, and each part before what comes after the loop. Nothing is promised between parts, so
// races between them are found.
#pragma once

#include_next <tbb/parallel_for.h>

#include <concepts>

#include <sanitizer/tsan_interface.h>

namespace relumine::tsan {

/// Only their addresses matter.
struct LoopMarks {
    char before = 0;
    char after = 0;
};

/// What TBB copies from thread to thread, by which the sanitizer would already be misled: it does
/// not watch this.
template<class Body>
struct MarkedBody {
    const Body* body;
    LoopMarks* marks;

    struct EndOfPart {
        LoopMarks* marks;
        [[gnu::no_sanitize_thread]] ~EndOfPart() { __tsan_release(&marks->after); }
    };

    template<class Range>
    [[gnu::no_sanitize_thread]] void operator()(const Range& range) const {
        const Range own = range; // another thread may have split it off
        __tsan_acquire(&marks->before);
        const EndOfPart end{marks};
        (*body)(own);
    }
};

template<class Body, class Loop>
void mark(const Body& body, const Loop& loop) {
    LoopMarks marks;
    struct EndOfLoop {
        LoopMarks& marks;
        ~EndOfLoop() { __tsan_acquire(&marks.after); }
    };
    __tsan_release(&marks.before);
    const EndOfLoop end{marks};
    loop(MarkedBody<Body>{&body, &marks});
}

} // namespace relumine::tsan

namespace tbb {

template<class Range, class Body, class... Partitioner>
void marked_parallel_for(const Range& range, const Body& body, const Partitioner&... partitioner) {
    relumine::tsan::mark(body,
                         [&](const auto& marked) { parallel_for(range, marked, partitioner...); });
}

template<std::integral Index, class Body>
void marked_parallel_for(Index first, Index last, const Body& body) {
    relumine::tsan::mark(body, [&](const auto& marked) { parallel_for(first, last, marked); });
}

} // namespace tbb

#define parallel_for marked_parallel_for
