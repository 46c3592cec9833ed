//! Scripts that give the points of a sweep to a scheduler.

use std::time::Duration;

use lennard_io::in_shell;

use super::Plan;
use crate::report::filled;

/// The texts of the scripts, with words in braces.
const SLURM: &str = include_str!("slurm.sh");
const PARALLEL: &str = include_str!("parallel.sh");
const SNAKEFILE: &str = include_str!("snakefile");

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
        // Number and threads of a task stand as the scheduler writes them.
        let threads = self.threads.to_string();
        let (text, number, threads_of_task) = match scheduler {
            Scheduler::Slurm => (SLURM, "\"$SLURM_ARRAY_TASK_ID\"", "\"$SLURM_CPUS_PER_TASK\""),
            Scheduler::Parallel => (PARALLEL, "\"$1\"", &*threads),
            Scheduler::Snakemake => (SNAKEFILE, "{wildcards.task}", "{threads}"),
        };
        let command = match scheduler {
            // Snakemake takes what stands in braces for a name of its own.
            Scheduler::Snakemake => self.command.replace('{', "{{").replace('}', "}}"),
            Scheduler::Slurm | Scheduler::Parallel => self.command.clone(),
        };
        let chunk = match self.chunk {
            1 => String::new(),
            chunk => format!(" --chunk {chunk}"),
        };
        let task = format!("{command} --quiet --threads {threads_of_task} --point {number}{chunk}");
        let collect = format!("{command} --collect");
        let points = self.plan.points.len();
        let last = (points - 1) / self.chunk;
        let seconds = self.time.unwrap_or(DAY).as_secs().max(WARNED + 60);
        let words = [
            ("name", self.plan.name.to_string()),
            ("points", points.to_string()),
            ("tasks", (last + 1).to_string()),
            ("last", last.to_string()),
            ("threads", threads.clone()),
            ("time", format!("{:02}:{:02}:00", seconds / 3600, seconds % 3600 / 60)),
            ("warned", WARNED.to_string()),
            ("marker", in_python(&format!("{}/.tasks/{{task}}", self.folder))),
            ("table", in_python(&format!("{}/table.csv", self.folder))),
            ("task in python", in_python(&task)),
            ("task", task),
            ("collect in python", in_python(&collect)),
            ("collect in a shell", in_shell(&collect)),
            ("collect", collect),
        ];
        filled(text, &words)
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
