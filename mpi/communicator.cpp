#include "mpi/communicator.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#define OMPI_SKIP_MPICXX
#define MPICH_SKIP_MPICXX
#include <mpi.h>

#include "files/output_file.h"
#include "files/seconds.h"

namespace relumine::mpi {

namespace {

using Clock = std::chrono::steady_clock;

/// MPI counts with int.
constexpr std::size_t MostBytes = std::size_t{1} << 30;

constexpr int DataTag = 1;
constexpr int HereTag = 2;

/// A process that waits leaves its processor to others: MPI itself would spin.
void pause(double seconds_waited) {
    if (seconds_waited < 50e-6)
        return std::this_thread::yield();
    std::this_thread::sleep_for(
        std::chrono::duration<double>(std::clamp(seconds_waited / 20.0, 20e-6, 1e-3)));
}

int number(std::uint32_t process) {
    return static_cast<int>(process);
}

} // namespace

Communicator::Communicator() {
    // Only the thread that made it calls MPI, between parallel loops.
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    int rank = 0, size = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    part_ = {.index = static_cast<std::uint32_t>(rank), .count = static_cast<std::uint32_t>(size)};
}

Communicator::~Communicator() {
    MPI_Finalize();
}

void Communicator::set_timeout(double seconds, std::function<void(const std::string&)> complain) {
    timeout_ = seconds;
    complain_ = std::move(complain);
}

/// Waits for what `start` begins: it fills in a request.
template<typename Start>
void Communicator::run(const Start& start) {
    const Clock::time_point begin = Clock::now();
    MPI_Request request = MPI_REQUEST_NULL;
    start(request);
    for (int is_done = 0;;) {
        MPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
        if (is_done != 0)
            break;
        const double waited = files::seconds_since(begin);
        if (timeout_ > 0.0 && waited > timeout_)
            give_up();
        pause(waited);
    }
    seconds_waiting_ += files::seconds_since(begin);
}

std::int64_t Communicator::largest(std::int64_t value) {
    std::int64_t result = 0;
    run([&](MPI_Request& request) {
        MPI_Iallreduce(&value, &result, 1, MPI_INT64_T, MPI_MAX, MPI_COMM_WORLD, &request);
    });
    return result;
}

void Communicator::meet() {
    if (largest(0) != 0)
        throw OtherFailed();
}

/// Returns whether this process complains: the first one of several that fail at once.
bool Communicator::fail() {
    const std::int64_t own = part_.count - part_.index;
    return largest(own) == own;
}

/// Ends all processes. Those that wait tell the first two; one of these names the others.
void Communicator::give_up() {
    const auto tell = [&](std::uint32_t process) {
        static const char Here = 1;
        MPI_Request request = MPI_REQUEST_NULL;
        if (process != part_.index && process < part_.count)
            MPI_Isend(&Here, 1, MPI_CHAR, number(process), HereTag, MPI_COMM_WORLD, &request);
    };
    tell(0);
    tell(1);
    constexpr double Patience = 2.0; // seconds: the others wait about as long as this one
    std::set<std::uint32_t> here = {part_.index};
    for (const Clock::time_point begin = Clock::now();
         files::seconds_since(begin) < (part_.index == 0   ? 1.0
                                        : part_.index == 1 ? 1.5
                                                           : 2.0) *
                                           Patience;) {
        int has_message = 0;
        MPI_Status status;
        MPI_Iprobe(MPI_ANY_SOURCE, HereTag, MPI_COMM_WORLD, &has_message, &status);
        if (has_message != 0) {
            char byte = 0;
            MPI_Recv(&byte, 1, MPI_CHAR, status.MPI_SOURCE, HereTag, MPI_COMM_WORLD,
                     MPI_STATUS_IGNORE);
            here.insert(static_cast<std::uint32_t>(status.MPI_SOURCE));
        }
        pause(1e-3);
    }
    if (part_.index == 0 || (part_.index == 1 && !here.contains(0))) {
        std::vector<std::uint32_t> missing;
        for (std::uint32_t process = 0; process < part_.count; ++process)
            if (!here.contains(process))
                missing.push_back(process);
        complain_(fmt::format(
            "expected all {} processes to answer within {} s, got none from {}", part_.count,
            timeout_, missing.empty() ? "some" : fmt::format("{}", fmt::join(missing, ", "))));
    }
    files::abandon_outputs();
    MPI_Abort(MPI_COMM_WORLD, 1);
    std::abort();
}

void Communicator::reduce(std::span<std::int64_t> values, bool is_sum) {
    meet();
    run([&](MPI_Request& request) {
        MPI_Iallreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_INT64_T,
                       is_sum ? MPI_SUM : MPI_MAX, MPI_COMM_WORLD, &request);
    });
}

/// Calls start(piece, size, request) for pieces of some bytes.
template<typename Byte, typename Start>
void Communicator::run_in_pieces(std::span<Byte> bytes, const Start& start) {
    for (std::size_t begin = 0; begin < bytes.size(); begin += MostBytes)
        run([&](MPI_Request& request) {
            start(bytes.data() + begin, static_cast<int>(std::min(MostBytes, bytes.size() - begin)),
                  request);
        });
}

void Communicator::broadcast_from(std::uint32_t process, std::span<std::byte> bytes) {
    run_in_pieces(bytes, [&](std::byte* piece, int size, MPI_Request& request) {
        MPI_Ibcast(piece, size, MPI_BYTE, number(process), MPI_COMM_WORLD, &request);
    });
}

void Communicator::send(std::span<const std::byte> bytes, std::uint32_t to) {
    run_in_pieces(bytes, [&](const std::byte* piece, int size, MPI_Request& request) {
        MPI_Isend(piece, size, MPI_BYTE, number(to), DataTag, MPI_COMM_WORLD, &request);
    });
}

void Communicator::receive(std::span<std::byte> bytes, std::uint32_t from) {
    run_in_pieces(bytes, [&](std::byte* piece, int size, MPI_Request& request) {
        MPI_Irecv(piece, size, MPI_BYTE, number(from), DataTag, MPI_COMM_WORLD, &request);
    });
}

/// What each process is about to send, in bytes.
std::vector<std::size_t> Communicator::sizes(std::size_t own) {
    meet();
    const std::uint64_t own_size = own;
    std::vector<std::uint64_t> of_all(part_.count);
    run([&](MPI_Request& request) {
        MPI_Iallgather(&own_size, 1, MPI_UINT64_T, of_all.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD,
                       &request);
    });
    return {of_all.begin(), of_all.end()};
}

std::vector<std::byte> Communicator::broadcast(std::vector<std::byte> bytes) {
    bytes.resize(sizes(bytes.size()).front());
    meet(); // all have the memory
    broadcast_from(0, bytes);
    return bytes;
}

std::vector<std::vector<std::byte>> Communicator::all_gather(std::vector<std::byte> bytes) {
    const std::vector<std::size_t> of_each = sizes(bytes.size());
    std::vector<std::vector<std::byte>> of_all(part_.count);
    of_all[part_.index] = std::move(bytes);
    for (std::size_t i = 0; i < of_all.size(); ++i)
        of_all[i].resize(of_each[i]);
    meet(); // all have the memory
    // MPI_Iallgatherv counts the bytes of all processes together with int; these do not.
    for (std::uint32_t i = 0; i < part_.count; ++i)
        broadcast_from(i, of_all[i]);
    return of_all;
}

std::vector<std::vector<std::byte>> Communicator::gather(std::vector<std::byte> bytes) {
    const std::vector<std::size_t> of_each = sizes(bytes.size());
    std::vector<std::vector<std::byte>> of_all(part_.index == 0 ? part_.count : 0);
    for (std::size_t i = 1; i < of_all.size(); ++i)
        of_all[i].resize(of_each[i]);
    meet(); // the first has the memory
    if (part_.index != 0) {
        send(bytes, 0);
        return {};
    }
    of_all[0] = std::move(bytes);
    for (std::uint32_t i = 1; i < part_.count; ++i)
        receive(of_all[i], i);
    return of_all;
}

std::vector<std::byte> Communicator::scatter(std::vector<std::vector<std::byte>> bytes) {
    meet();
    std::vector<std::uint64_t> of_each(part_.count);
    for (std::size_t i = 0; i < bytes.size(); ++i)
        of_each[i] = bytes[i].size();
    broadcast_from(0, std::as_writable_bytes(std::span(of_each)));
    std::vector<std::byte> own(part_.index != 0 ? static_cast<std::size_t>(of_each[part_.index])
                                                : 0);
    meet(); // all have the memory
    if (part_.index != 0) {
        receive(own, 0);
        return own;
    }
    for (std::uint32_t i = 1; i < part_.count; ++i)
        send(bytes[i], i);
    return std::move(bytes[0]);
}

} // namespace relumine::mpi
