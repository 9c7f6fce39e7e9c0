// A batch as a Nextflow workflow: every task makes one shard, and the last task merges them.
//
//   nextflow run pinswitch.nf --sweep $PWD/sweep.toml --out $PWD/out/sweep --shards 4
//
// `out` is an absolute path of a folder that all tasks share, or an object store. A task that is killed resumes its shard.
params.shards = 4
params.pinswitch = 'pinswitch'

process shard {
    cpus 2
    memory '500 MB'
    errorStrategy 'retry'
    maxRetries 3
    input: val k
    output: val k
    script: "'${params.pinswitch}' batch '${params.sweep}' --out '${params.out}' --shard ${k}/${params.shards} --threads ${task.cpus} --yes"
}

process merge {
    input: val shards
    script: "'${params.pinswitch}' merge '${params.out}'"
}

workflow { merge(shard(channel.of(1..(params.shards as int))).collect()) }
