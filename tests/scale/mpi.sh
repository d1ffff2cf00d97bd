#!/usr/bin/env bash
# Runs relumine-mpi on this one host, with more ranks than processors: the bytes of `relumine`, from any number of ranks, after
# any of them was killed, and one clear line when something is wrong.
#   mpi.sh RELUMINE RELUMINE_MPI
set -euo pipefail
relumine=$(realpath "$1")
relumine_mpi=$(realpath "$2")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

as_root=()
[ "$(id -u)" -ne 0 ] || as_root=(--allow-run-as-root)
start() { # RANKS ARGS: rank by rank, no network
    local ranks=$1
    shift
    mpirun "${as_root[@]}" --oversubscribe --bind-to none --mca btl self,vader -n "$ranks" "$relumine_mpi" "$@"
}

# ranks_of RUN: the processes of a start() in the background.
ranks_of() {
    local run
    run=$(pgrep -P "$1" -x mpirun || echo "$1")
    pgrep -P "$run" -x relumine-mpi || true
}

failed=0
check() { # NAME CONDITION...
    local name=$1
    shift
    if "$@"; then echo "$name: as it should be"; else echo "$name: WRONG"; failed=1; fi
}

"$relumine" generate knot -o . --vertices 6000 -q
cat >squares.obj <<'OBJ'
v -1 0 1
v 1 0 1
v 1 0 -1
v -1 0 -1
v -0.5 0.5 0.5
v 0.5 0.5 0.5
v 0.5 0.5 -0.5
v -0.5 0.5 -0.5
vt 0.02 0.02
vt 0.48 0.02
vt 0.48 0.98
vt 0.02 0.98
vt 0.52 0.02
vt 0.98 0.02
vt 0.98 0.98
vt 0.52 0.98
f 1/1 2/2 3/3
f 1/1 3/3 4/4
f 5/5 6/6 7/7
f 5/5 7/7 8/8
OBJ
vertices=(knot.ply --floor 30 --tolerance 0.03 --bounces 0)
glossy=(knot.ply --tolerance 0.06 --view auto --material ggx:roughness=0.4,f0=0.04 --glossy-tolerance 0.2)
texels=(squares.obj --receivers texels:96x96 --tolerance 0.03)
bouncing=(knot.ply --floor 50 --tolerance 0.05 --bounces)
bouncing_texels=(squares.obj --receivers texels:64x64 --tolerance 0.05 --bounces --two-sided)
bouncing_glossy=("${glossy[@]}" --bounces 0.02)
points=(knot.ply --receivers grid:20x12x10 --face-resolution 32)
for kind in vertices glossy texels bouncing bouncing_texels bouncing_glossy points; do
    declare -n options=$kind
    "$relumine" precompute "${options[@]}" -o "$kind.prt" -q
    for ranks in 1 2 3 5 8; do
        start "$ranks" precompute "${options[@]}" -o shared.prt --threads 1 -q
        check "$kind, $ranks ranks" cmp -s "$kind.prt" shared.prt
        rm -f shared.prt
    done
done
start 1 precompute "${vertices[@]}" -o shared.prt --threads 2 -q
check "1 rank of 2 threads" cmp -s vertices.prt shared.prt
rm -f shared.prt

# Light: each rank reads its own tiles and rows.
"$relumine" generate sun_sky -o . --face-resolution 64 -q
light() { # SCENE OUTPUT ARGS
    local scene=$1 output=$2
    shift 2
    "$relumine" relight "$scene.prt" sun_sky.exr -o "whole$output" "$@" -q
    for ranks in 1 2 3 5 8; do
        start "$ranks" relight "$scene.prt" sun_sky.exr -o "shared$output" "$@" --threads 1 -q
        check "light of $scene ($output $*), $ranks ranks" cmp -s "whole$output" "shared$output"
        rm -f "shared$output"
    done
}
light vertices .npy
light glossy .npy
light glossy .png --size 120x90
light bouncing_glossy .npy
light texels .npy
light texels .exr
light points .npy
"$relumine" relight points.prt sun_sky.exr -o whole.npy --harmonics coefficients.npy -q
for ranks in 2 5; do
    start "$ranks" relight points.prt sun_sky.exr -o shared.npy --harmonics shared_coefficients.npy --threads 1 -q
    check "coefficients of points, $ranks ranks" cmp -s coefficients.npy shared_coefficients.npy
done
rm -f shared.npy
light bouncing .npy
light bouncing .png --size 200x150
light bouncing .ply --bounces 2
light bouncing_texels .exr --bounces only
"$relumine" lights sun_sky.exr --number 12 -o lamps.json -q
light bouncing .png --size 120x90 --lights lamps.json
light glossy .npy --lights lamps.json
"$relumine" relight bouncing.prt --lights lamps.json -o whole.npy -q
for ranks in 1 3 8; do
    start "$ranks" relight bouncing.prt --lights lamps.json -o shared.npy --threads 1 -q
    check "a list of lights, $ranks ranks" cmp -s whole.npy shared.npy
done

"$relumine" verify bouncing.prt sun_sky.exr --samples 60 --paths 8 --json -q | grep -v '"seconds"' >whole.json
for ranks in 1 2 3 8; do
    start "$ranks" verify bouncing.prt sun_sky.exr --samples 60 --paths 8 --threads 1 --json |
        grep -v '"seconds"' >shared.json
    check "verify, $ranks ranks" cmp -s whole.json shared.json
done

# Frames, also those of a second run that goes on.
"$relumine" generate sequence sun -o frames --frames 4 --face-resolution 32 -q
mkdir whole shared
animate=(animate bouncing.prt 'frames/sun.####.exr' --size 120x90 -q)
"$relumine" "${animate[@]}" -o 'whole/f.####.png' --vertices whole/v.npy
for ranks in 1 2 3 8; do
    rm -f shared/*
    start "$ranks" "${animate[@]}" -o 'shared/f.####.png' --vertices shared/v.npy --threads 1
    rm shared/f.0002.png
    start "$ranks" "${animate[@]}" -o 'shared/f.####.png' --vertices shared/v.npy --threads 1 --resume
    rm -f whole/*.done shared/*.done
    check "frames, $ranks ranks" diff -rq whole shared
done

# Kills a rank at each of several moments. What is left goes on, or begins anew where there was no checkpoint yet.
survives() { # NAME "DELAYS" OPTIONS...: of precompute
    local name=$1 delays=$2 num_killed=0 delay run rank
    shift 2
    "$relumine" precompute "$@" -o longer.prt -q
    rm -f killed.prt
    local ranks=0
    for delay in $delays; do
        ranks=$((ranks % 3 + 1)) # another number goes on
        start "$ranks" precompute "$@" --checkpoint-seconds 0.05 -o killed.prt --threads 1 --resume -q >kill.log 2>&1 &
        run=$!
        sleep "$delay"
        rank=$(ranks_of "$run" | sort -R | head -n 1)
        [ -z "$rank" ] || { kill -9 "$rank" 2>/dev/null && num_killed=$((num_killed + 1)); }
        wait "$run" || true
    done
    start 3 precompute "$@" --checkpoint-seconds 0.05 -o killed.prt --threads 1 --resume -q
    check "$num_killed ranks killed $name, then --resume" cmp -s longer.prt killed.prt
}
survives "among clusters" "0.6 0.8 1.0 1.2 1.4 1.6 1.8 2.0 2.3 2.6" knot.ply --floor 60 --tolerance 0.012
survives "among bounces" "0.8 1.2 1.6 2.0 2.4" knot.ply --floor 60 --tolerance 0.05 --bounces 0.004
# Whoever survives says how to go on.
start 3 precompute knot.ply --floor 60 --tolerance 0.012 --checkpoint-seconds 0.05 -o killed.prt --threads 1 -q >kill.log 2>&1 &
run=$!
until [ -e killed.prt.checkpoint/run.json ] || ! kill -0 "$run" 2>/dev/null; do sleep 0.1; done
kill -9 "$(ranks_of "$run" | tail -n 1)"
wait "$run" || true
check "a survivor names --resume: $(grep -m 1 '^relumine-mpi: ' kill.log || true)" \
    grep -q '^relumine-mpi: .* --resume goes on from killed.prt.checkpoint' kill.log
rm -rf killed.prt.checkpoint
# Told to end by its user or the batch system, the whole says one line.
for signal in TERM INT; do
    for seconds in 0 20; do
        for delay in 0.3 1 2.5; do
            start 3 precompute knot.ply --floor 60 --tolerance 0.002 --checkpoint-seconds "$seconds" -o ended.prt --threads 1 -q \
                >ended.log 2>&1 &
            run=$!
            sleep "$delay"
            kill -"$signal" "$(pgrep -P "$run" -x mpirun || echo "$run")"
            code=0
            wait "$run" || code=$?
            check "SIG$signal after $delay s: $(grep '^relumine-mpi: ' ended.log || true)" \
                test "$code" -ne 0 -a "$(grep -c '^relumine-mpi: ' ended.log)" -le 1 -a ! -e ended.prt
            rm -rf ended.prt.checkpoint
        done
    done
done
check "no checkpoint is left" test ! -e killed.prt.checkpoint

refuses() { # NAME CODE TEXT COMMAND...: one line of relumine-mpi, which has the text; nothing written
    local name=$1 code=$2 text=$3 got=0
    shift 3
    rm -f out.prt
    "$@" >refusal.log 2>&1 || got=$?
    local lines
    lines=$(grep -c '^relumine-mpi: ' refusal.log || true)
    if [ "$got" -ne "$code" ] || [ "$lines" -ne 1 ] || ! grep -q -- "$text" refusal.log || [ -e out.prt ]; then
        echo "$name: WRONG: exit code $got, $lines lines"
        cat refusal.log
        failed=1
    else
        echo "$name: $(grep '^relumine-mpi: ' refusal.log)"
    fi
}
refuses "no mesh" 1 "nothing.ply" start 3 precompute nothing.ply -o out.prt
refuses "other arguments" 1 "process 1: expected the arguments" \
    mpirun "${as_root[@]}" --oversubscribe --mca btl self,vader \
    -n 1 "$relumine_mpi" precompute knot.ply -o out.prt : -n 1 "$relumine_mpi" precompute squares.obj -o out.prt
refuses "no folder" 1 "no/such/out.prt" start 3 precompute "${vertices[@]}" -o no/such/out.prt -q
refuses "another command" 2 "expected precompute" start 3 info vertices.prt
refuses "lights that are none" 1 "whole.json:2: expected" \
    start 2 relight vertices.prt sun_sky.exr --lights whole.json -o out.npy -q
refuses "bounces of a scene without" 1 "vertices.prt: expected a scene made with" \
    start 2 relight vertices.prt sun_sky.exr --bounces 3 -o out.npy
refuses "frames that are not there" 1 "nothing" start 2 animate vertices.prt 'nothing.####.exr' -o 'out.####.png'
# The same arguments name other files on another host.
mkdir other
cp texels.prt other/vertices.prt
cp sun_sky.exr other
for command in "relight vertices.prt sun_sky.exr -o out.npy" "verify vertices.prt sun_sky.exr --samples 10"; do
    # shellcheck disable=SC2086 # several words
    refuses "another scene (${command%% *})" 1 "process 1: vertices.prt: expected the scene and the light" \
        mpirun "${as_root[@]}" --oversubscribe --mca btl self,vader \
        --wdir "$folder" -n 1 "$relumine_mpi" $command -q : --wdir "$folder/other" -n 1 "$relumine_mpi" $command -q
done
refuses "parts" 2 "expected a mesh" start 2 precompute knot.plan --part 1/2 -o out.prt
refuses "a limit of memory" 1 "no limit of memory" start 2 precompute knot.ply --max-memory 1G -o out.prt
if mkdir small && mount -t tmpfs -o size=100k none small 2>/dev/null; then
    refuses "a full disk" 1 "small/out.prt: cannot write" start 3 precompute "${vertices[@]}" -o small/out.prt -q
    check "nothing is left on it" test -z "$(ls small)"
    umount small
else
    echo "a full disk: cannot be made here"
fi

# A rank that is stopped never answers.
start 3 precompute knot.ply --floor 60 --tolerance 0.012 -o out.prt --threads 1 --timeout 3 >silent.log 2>&1 &
run=$!
silent=
while [ -z "$silent" ] && kill -0 "$run" 2>/dev/null; do
    sleep 0.5
    silent=$(ranks_of "$run" | tail -n 1)
done
sleep 1
kill -STOP "$silent"
code=0
wait "$run" || code=$?
kill -9 "$silent" 2>/dev/null || true
check "a rank that never answers: $(grep '^relumine-mpi: ' silent.log || true)" \
    test "$code" -eq 1 -a "$(grep -c '^relumine-mpi: expected all 3 processes to answer' silent.log)" -eq 1 -a ! -e out.prt
exit "$failed"
