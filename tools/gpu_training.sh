#!/usr/bin/env bash
# A crop network trained for some minutes on a machine with a GPU and no network, its weights brought home in parts.
#
#     tools/gpu_training.sh MISSION START.safetensors OUT MINUTES [BATCH]
#
# Runs from a clone, without installing it. Python needs torch with CUDA, numba, opencv-python-headless and the packages
# that pyproject.toml names for the core and for `train`; where they are not there, bring their wheels and set PYTHONPATH.
# All processors but one draw crops that never repeat; the GPU learns each of them some times in bfloat16. The learning
# rate falls with the time that is given. OUT gets the curve, the log and the weights as float16 in parts of 15 MiB:
#
#     cat OUT/weights.part.* > weights.safetensors        # join; a longer training starts from these
#
# Try it on a processor first: MINUTES=1 and a BATCH of 8 show that everything is there.
set -euo pipefail
mission=$1 start=$2 out=$3 minutes=$4 batch=${5:-256}
workers=$(($(nproc) > 1 ? $(nproc) - 1 : 1))
export PYTHONPATH="$PWD/src${PYTHONPATH:+:$PYTHONPATH}" OMP_NUM_THREADS=1 NUMBA_NUM_THREADS=1
export NUMBA_CACHE_DIR="${NUMBA_CACHE_DIR:-/tmp/numba}"
work=$(mktemp -d)
mkdir -p "$out"
# Compiles the kernels once, for all processes.
python3 -m proxnav.cli.main mission show "$mission" --frames 1 --drawn 1 --out "$work/first.png" >/dev/null
hours=$(python3 -c "print($minutes / 60)")
python3 -m proxnav.cli.main train heatmap --mission "$mission" --out "$work" --side 192 --workers "$workers" --repeats 6 \
    --training.start "$start" --training.rate 1e-3 --training.loop.steps 1000000 --training.loop.hours "$hours" \
    --training.loop.batch-size "$batch" --training.loop.log-every 10 --training.loop.save-every 200 \
    --training.loop.average-decay 0.99 2>&1 | tee "$out/train.log"
cp "$work/curve.csv" "$out/"
python3 - "$work/weights.safetensors" "$work/half.safetensors" <<'PY'
import sys
from safetensors import safe_open
from safetensors.torch import save_file
with safe_open(sys.argv[1], "pt") as file:
    tensors, notes = {name: file.get_tensor(name) for name in file.keys()}, file.metadata()
halves = {name: value.half() if value.is_floating_point() else value for name, value in tensors.items()}
save_file({name: value.contiguous() for name, value in halves.items()}, sys.argv[2], notes)
PY
split -b 15M "$work/half.safetensors" "$out/weights.part."
ls -l "$out"
