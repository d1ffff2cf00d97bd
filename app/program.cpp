#include "app/program.h"

#include <exception>
#include <new>

#include <fmt/format.h>

#include "app/command_line/documentation.h"
#include "app/commands.h"
#include "relumine/in/shared_work.h"

namespace relumine::app {

void add_commands(CommandLine& line, Session& session) {
    Command program = line.root();
    add_precompute(program, session);
    add_plan(program, session);
    add_join(program, session);
    add_relight(program, session);
    add_animate(program, session);
    add_edit(program, session);
    add_verify(program, session);
    add_fit(program, session);
    add_lights(program, session);
    add_info(program, session);
    add_generate(program, session);
    add_mesh(program, session);
    add_env(program, session);
    add_coarsen(program, session);
    add_move(program, session);
    add_export(program, session);
    add_export_web(program, session);
    add_view(program, session);
    add_help(line);
    add_completion(line);
}

int exit_code_of(const CommandLine& line, const std::function<void()>& work,
                 const std::function<void(const std::string&)>& complain) {
    try {
        work();
        return 0;
    } catch (const UsageError& error) {
        complain(fmt::format("{} (see {} --help)", error.what(), line.command_name()));
        return 2;
    } catch (const prt::Cancelled&) {
        complain("cancelled; nothing was written");
    } catch (const std::bad_alloc&) {
        complain("out of memory");
    } catch (const std::exception& error) {
        complain(error.what());
    }
    return 1;
}

} // namespace relumine::app
