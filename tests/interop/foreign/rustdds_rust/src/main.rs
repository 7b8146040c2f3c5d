//! Rust and rustdds, with types that types_of_idl.py makes from dyncal.idl. It has no partitions: it
//! reads and writes in the default one.
//!
//!     rustdds_rust read DOMAIN PARTITION BENCH RESULTS FUNCTIONS
//!     rustdds_rust write DOMAIN PARTITION BENCH SECONDS
//!
//! What is printed and written is in README.md.
use rustdds::{
    policy::{DataRepresentation, Durability, History, Reliability, XCDR_DATA_REPRESENTATION},
    with_key::{DataReaderCdr, DataWriterCdr, Sample},
    DomainParticipant, Keyed, QosPolicies, QosPolicyBuilder, Topic, TopicKind,
};
use std::time::{Duration, Instant};

#[allow(dead_code)]
mod wire {
    use cdr_encoding_size::CdrEncodingSize;
    use rustdds::{Key, Keyed};
    use serde::{Deserialize, Serialize};
    include!(env!("DYNCAL_TYPES"));
}

const SAMPLES_A_BLOCK: u64 = 20;
const BLOCK: Duration = Duration::from_millis(20);

fn qos(kept: i32) -> QosPolicies {
    QosPolicyBuilder::new()
        .reliability(Reliability::Reliable { max_blocking_time: rustdds::Duration::from_secs(10) })
        .durability(Durability::TransientLocal)
        .history(History::KeepLast { depth: kept })
        .build()
        .with_data_representation(DataRepresentation { value: vec![XCDR_DATA_REPRESENTATION] })
}

fn topic(participant: &DomainParticipant, name: &str, message: &str, kept: i32) -> Topic {
    let type_name = format!("dyncal::wire::{message}");
    participant.create_topic(name.into(), type_name, &qos(kept), TopicKind::WithKey).unwrap()
}

fn print_result(one: &wire::CalibrationResult) {
    println!(
        "CalibrationResult\t{}\t{}\t{}\t{}\t{}\t{}\t{:?}\t{:?}\t{:?}\t{:?}\t{}\t{}\t{}",
        one.bench,
        one.run,
        one.channel,
        one.step,
        one.repetition,
        one.frequency_text_hz,
        one.magnitude,
        one.u_magnitude,
        one.phase_rad,
        one.u_phase_rad,
        one.unit,
        one.budget.len(),
        one.software
    );
}

fn print_function(one: &wire::TransferFunction) {
    print!(
        "TransferFunction\t{}\t{}\t{}\t{}\t{:?}\t{}",
        one.bench,
        one.run,
        one.channel,
        one.unit,
        one.group_delay_s,
        one.points.len()
    );
    for point in &one.points {
        print!("\t{:?}\t{:?}\t{:?}", point.magnitude, point.phase_rad, point.u_phase_rad);
    }
    println!();
}

fn taken<T>(reader: &mut DataReaderCdr<T>) -> Vec<T>
where
    T: Keyed + serde::de::DeserializeOwned + 'static,
    for<'de> T::K: serde::Deserialize<'de>,
{
    let mut messages = Vec::new();
    while let Ok(Some(sample)) = reader.take_next_sample() {
        if let Sample::Value(message) = sample.into_value() {
            messages.push(message);
        }
    }
    messages
}

fn read(participant: &DomainParticipant, bench: &str, counts: &[String]) {
    let subscriber = participant.create_subscriber(&qos(1)).unwrap();
    let points = topic(participant, "CalibrationResult", "CalibrationResult", 1);
    let curves = topic(participant, "TransferFunction", "TransferFunction", 1);
    let mut points =
        subscriber.create_datareader_cdr::<wire::CalibrationResult>(&points, None).unwrap();
    let mut curves =
        subscriber.create_datareader_cdr::<wire::TransferFunction>(&curves, None).unwrap();
    let (mut results, mut functions) =
        (counts[0].parse::<usize>().unwrap(), counts[1].parse::<usize>().unwrap());
    while results > 0 || functions > 0 {
        for one in taken(&mut points).iter().filter(|one| one.bench == bench) {
            print_result(one);
            results = results.saturating_sub(1);
        }
        for one in taken(&mut curves).iter().filter(|one| one.bench == bench) {
            print_function(one);
            functions = functions.saturating_sub(1);
        }
        std::thread::sleep(BLOCK);
    }
}

fn channel(name: &str, quantity: &str, unit: &str) -> wire::ChannelDescription {
    wire::ChannelDescription {
        name: name.into(),
        quantity: quantity.into(),
        unit: unit.into(),
        ..Default::default()
    }
}

fn write(participant: &DomainParticipant, bench: &str, seconds: f64) {
    let publisher = participant.create_publisher(&qos(250)).unwrap();
    let described = topic(participant, "SourceDescription", "SourceDescription", 1);
    let sampled = topic(participant, "AcsSamples", "SampleBlock", 250);
    let descriptions: DataWriterCdr<wire::SourceDescription> =
        publisher.create_datawriter_cdr(&described, Some(qos(1))).unwrap();
    let blocks: DataWriterCdr<wire::SampleBlock> =
        publisher.create_datawriter_cdr(&sampled, None).unwrap();
    let session = std::time::UNIX_EPOCH.elapsed().unwrap().as_nanos() as u64;
    let source = wire::SourceDescription {
        bench: bench.into(),
        source: "acs".into(),
        session,
        kind: wire::SOURCE_ACS,
        device: "foreign source".into(),
        channels: vec![
            channel("reference", "Acceleration", r"\metre\second\tothe{-2}"),
            channel("sync", "Voltage", r"\volt"),
        ],
        nominal_rate_hz: 1000.0,
        contract_version: wire::CONTRACT_VERSION,
        ..Default::default()
    };
    descriptions.write(source, None).unwrap();
    let begin = Instant::now();
    let count = (seconds / BLOCK.as_secs_f64()) as u64;
    for number in 0..=count {
        let first = number * SAMPLES_A_BLOCK;
        let length = if number < count { SAMPLES_A_BLOCK } else { 0 };
        let samples = first..first + length;
        let block = wire::SampleBlock {
            bench: bench.into(),
            source: "acs".into(),
            session,
            block: number,
            first_sample: first,
            sample_count: length as u32,
            channel_count: if length > 0 { 2 } else { 0 },
            end_of_stream: length == 0,
            origin_ns: 250_000_000_000_000_000,
            interval_numerator_ns: 1_000_000,
            interval_denominator: 1,
            values: samples
                .clone()
                .map(|n| n as f64 * 0.25)
                .chain(samples.map(|n| n as f64 * -0.5))
                .collect(),
            ..Default::default()
        };
        blocks.write(block, None).unwrap();
        let due = begin + BLOCK * number as u32;
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
    }
    println!("written\t{}", count * SAMPLES_A_BLOCK);
    std::thread::sleep(Duration::from_secs(3)); // repairs of the last blocks
}

fn main() {
    let words: Vec<String> = std::env::args().collect();
    let participant = DomainParticipant::new(words[2].parse().unwrap()).unwrap();
    if words[1] == "write" {
        write(&participant, &words[4], words[5].parse().unwrap());
    } else {
        read(&participant, &words[4], &words[5..]);
    }
}
