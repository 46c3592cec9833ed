#!/bin/bash
# The sweep {name}: {points} points in {tasks} tasks.
#   job=$(sbatch --parsable THIS_FILE)
#   sbatch --dependency=afterany:$job --wrap {collect in a shell}
# A task that runs out of time leaves a checkpoint: submit the file again, and it goes on.
#SBATCH --job-name={name}
#SBATCH --array=0-{last}
#SBATCH --cpus-per-task={threads}
#SBATCH --time={time}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:TERM@{warned}
exec {task}
