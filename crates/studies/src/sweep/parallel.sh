#!/bin/bash
# The sweep {name}: {points} points in {tasks} tasks.
# With --sshloginfile NODES --workdir . the tasks run on many machines that share this folder.
task() { {task}; }
export -f task
seq 0 {last} | parallel --line-buffer --env task task
{collect}
