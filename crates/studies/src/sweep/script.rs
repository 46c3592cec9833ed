//! Scripts that give the points of a sweep to a scheduler.

use std::fmt::Write as _;
use std::time::Duration;

use lennard_io::in_shell;

use super::Plan;

/// Seconds between the signal of Slurm and the end of a task: time for a checkpoint.
const WARNED: u64 = 120;
/// The time of a task where none is given.
const DAY: Duration = Duration::from_secs(24 * 3600);

/// Programs that run the tasks of a script.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheduler {
    /// Slurm: a job array.
    Slurm,
    /// GNU parallel, on one machine or on many with a common folder.
    Parallel,
    /// Snakemake.
    Snakemake,
}

/// What a script says.
#[derive(Debug)]
pub struct Script<'a> {
    /// The sweep.
    pub plan: &'a Plan,
    /// The command of the whole sweep as a shell reads it, such as `lennard sweep isotherm.toml --out runs/isotherm`.
    pub command: String,
    /// The output folder, without braces.
    pub folder: String,
    /// Points in one task.
    pub chunk: usize,
    /// Threads of one task.
    pub threads: usize,
    /// The time that a task may take.
    pub time: Option<Duration>,
}

impl Script<'_> {
    /// The text of the script.
    #[must_use]
    pub fn text(&self, scheduler: Scheduler) -> String {
        match scheduler {
            Scheduler::Slurm => self.slurm(),
            Scheduler::Parallel => self.parallel(),
            Scheduler::Snakemake => self.snakemake(),
        }
    }

    /// The number of the last task.
    fn last(&self) -> usize {
        (self.plan.points.len() - 1) / self.chunk
    }

    /// The command of one task, with number and threads as the scheduler writes them.
    fn task(&self, command: &str, number: &str, threads: &str) -> String {
        let mut task = format!("{command} --quiet --threads {threads} --point {number}");
        if self.chunk > 1 {
            let _ = write!(task, " --chunk {}", self.chunk);
        }
        task
    }

    /// A first line about the points and tasks.
    fn about(&self) -> String {
        let (points, tasks) = (self.plan.points.len(), self.last() + 1);
        format!("# The sweep {}: {points} points in {tasks} tasks.", self.plan.name)
    }

    fn slurm(&self) -> String {
        let seconds = self.time.unwrap_or(DAY).as_secs().max(WARNED + 60);
        let (hours, minutes) = (seconds / 3600, seconds % 3600 / 60);
        format!(
            "#!/bin/bash\n{about}\n\
             #   job=$(sbatch --parsable THIS_FILE)\n\
             #   sbatch --dependency=afterany:$job --wrap {collect}\n\
             # A task that runs out of time leaves a checkpoint: submit the file again, and it goes on.\n\
             #SBATCH --job-name={name}\n\
             #SBATCH --array=0-{last}\n\
             #SBATCH --cpus-per-task={threads}\n\
             #SBATCH --time={hours:02}:{minutes:02}:00\n\
             #SBATCH --requeue\n\
             #SBATCH --open-mode=append\n\
             #SBATCH --signal=B:TERM@{WARNED}\n\
             exec {task}\n",
            about = self.about(),
            collect = in_shell(&format!("{} --collect", self.command)),
            name = self.plan.name,
            last = self.last(),
            threads = self.threads,
            task = self.task(&self.command, "\"$SLURM_ARRAY_TASK_ID\"", "\"$SLURM_CPUS_PER_TASK\""),
        )
    }

    fn parallel(&self) -> String {
        format!(
            "#!/bin/bash\n{about}\n\
             # With --sshloginfile NODES --workdir . the tasks run on many machines that share this folder.\n\
             task() {{ {task}; }}\n\
             export -f task\n\
             seq 0 {last} | parallel --line-buffer --env task task\n\
             {command} --collect\n",
            about = self.about(),
            last = self.last(),
            task = self.task(&self.command, "\"$1\"", &self.threads.to_string()),
            command = self.command,
        )
    }

    fn snakemake(&self) -> String {
        // Snakemake takes what stands in braces for a name of its own.
        let command = self.command.replace('{', "{{").replace('}', "}}");
        let marker = format!("{}/.tasks/{{task}}", self.folder);
        format!(
            "{about}\n\
             # snakemake --cores all --snakefile THIS_FILE\n\n\
             rule collect:\n    \
                 input: expand({marker}, task=range({tasks}))\n    \
                 output: {table}\n    \
                 shell: {collect}\n\n\
             rule task:\n    \
                 output: touch({marker})\n    \
                 threads: {threads}\n    \
                 shell: {task}\n",
            about = self.about(),
            marker = in_python(&marker),
            table = in_python(&format!("{}/table.csv", self.folder)),
            collect = in_python(&format!("{command} --collect")),
            tasks = self.last() + 1,
            threads = self.threads,
            task = in_python(&self.task(&command, "{wildcards.task}", "{threads}")),
        )
    }
}

/// A text as Python reads it, on one line: texts of JSON are texts of Python.
fn in_python(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::super::plan;
    use super::*;

    fn script(scheduler: Scheduler, chunk: usize, time: Option<Duration>) -> String {
        let isotherm = lennard_scene::shipped::locate("sweep/isotherm".as_ref());
        let plan = plan(&isotherm, &[]).unwrap();
        let script = Script {
            command: "lennard sweep sweep/isotherm --out runs/iso".to_owned(),
            folder: "runs/iso".to_owned(),
            plan: &plan,
            chunk,
            threads: 2,
            time,
        };
        script.text(scheduler)
    }

    #[test]
    fn slurm_gets_an_array_with_a_task_for_each_chunk_and_its_time() {
        let text = script(Scheduler::Slurm, 3, Some(Duration::from_secs(5400)));
        assert!(text.contains("# The sweep isotherm: 8 points in 3 tasks."), "{text}");
        assert!(text.contains("#SBATCH --array=0-2\n"), "{text}");
        assert!(text.contains("#SBATCH --time=01:30:00\n"), "{text}");
        let task = "exec lennard sweep sweep/isotherm --out runs/iso --quiet --threads \"$SLURM_CPUS_PER_TASK\" \
            --point \"$SLURM_ARRAY_TASK_ID\" --chunk 3\n";
        assert!(text.ends_with(task), "{text}");
        assert!(text.lines().count() <= 20);
    }

    #[test]
    fn parallel_and_snakemake_get_each_task_and_collect_at_the_end() {
        let text = script(Scheduler::Parallel, 1, None);
        assert!(text.contains("seq 0 7 | parallel --line-buffer --env task task\n"), "{text}");
        assert!(text.contains("--threads 2 --point \"$1\"; }\n"), "{text}");
        assert!(text.ends_with("--out runs/iso --collect\n"), "{text}");
        let text = script(Scheduler::Snakemake, 1, None);
        assert!(text.contains("task=range(8))"), "{text}");
        assert!(text.contains("--threads {threads} --point {wildcards.task}\""), "{text}");
    }
}
