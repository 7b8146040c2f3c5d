//! Rust and dust_dds, with types that types_of_idl.py makes from dyncal.idl.
//!
//!     dust_rust read DOMAIN PARTITION BENCH RESULTS FUNCTIONS
//!     dust_rust write DOMAIN PARTITION BENCH SECONDS
//!
//! What is printed and written is in README.md.
use dust_dds::{
    domain::{
        domain_participant::DomainParticipant,
        domain_participant_factory::DomainParticipantFactory,
    },
    infrastructure::{
        domain::DomainId,
        listener::NO_LISTENER,
        qos::{DataReaderQos, DataWriterQos, PublisherQos, QosKind, SubscriberQos},
        qos_policy::{
            DataRepresentationQosPolicy, DurabilityQosPolicy, DurabilityQosPolicyKind,
            HistoryQosPolicy, HistoryQosPolicyKind, PartitionQosPolicy, ReliabilityQosPolicy,
            ReliabilityQosPolicyKind, WriterDataLifecycleQosPolicy, XCDR_DATA_REPRESENTATION,
        },
        sample_info::{ANY_INSTANCE_STATE, ANY_SAMPLE_STATE, ANY_VIEW_STATE},
        status::NO_STATUS,
        time::{Duration, DurationKind},
    },
    publication::{data_writer::DataWriter, publisher::Publisher},
    subscription::{data_reader::DataReader, subscriber::Subscriber},
    xtypes::type_support::TypeSupport,
};
use std::collections::HashSet;
use std::time::Instant;

#[allow(dead_code)]
mod wire {
    use dust_dds::infrastructure::type_support::DdsType;
    include!(env!("DYNCAL_TYPES"));
}

const SAMPLES_A_BLOCK: u64 = 20;
const BLOCK: std::time::Duration = std::time::Duration::from_millis(20);
const LONGEST_DISCOVERY: std::time::Duration = std::time::Duration::from_secs(4);

macro_rules! topic {
    ($participant:expr, $name:literal, $message:ident) => {
        $participant
            .create_topic::<wire::$message>(
                $name,
                concat!("dyncal::wire::", stringify!($message)),
                QosKind::Default,
                NO_LISTENER,
                NO_STATUS,
            )
            .unwrap()
    };
}

macro_rules! reader {
    ($participant:expr, $subscriber:expr, $name:literal, $message:ident) => {{
        let topic = topic!($participant, $name, $message);
        let made: DataReader<wire::$message> = $subscriber
            .create_datareader(&topic, QosKind::Specific(reader_qos()), NO_LISTENER, NO_STATUS)
            .unwrap();
        made
    }};
}

macro_rules! writer {
    ($participant:expr, $publisher:expr, $name:literal, $message:ident, $kept:literal) => {{
        let topic = topic!($participant, $name, $message);
        let made: DataWriter<wire::$message> = $publisher
            .create_datawriter(&topic, QosKind::Specific(writer_qos($kept)), NO_LISTENER, NO_STATUS)
            .unwrap();
        made
    }};
}

fn reliable() -> ReliabilityQosPolicy {
    ReliabilityQosPolicy {
        kind: ReliabilityQosPolicyKind::Reliable,
        max_blocking_time: DurationKind::Finite(Duration::new(10, 0)),
    }
}

fn transient_local() -> DurabilityQosPolicy {
    DurabilityQosPolicy { kind: DurabilityQosPolicyKind::TransientLocal }
}

fn plain_cdr() -> DataRepresentationQosPolicy {
    DataRepresentationQosPolicy { value: vec![XCDR_DATA_REPRESENTATION] }
}

fn reader_qos() -> DataReaderQos {
    DataReaderQos {
        reliability: reliable(),
        durability: transient_local(),
        representation: plain_cdr(),
        ..Default::default()
    }
}

fn writer_qos(kept: u32) -> DataWriterQos {
    DataWriterQos {
        reliability: reliable(),
        durability: transient_local(),
        history: HistoryQosPolicy { kind: HistoryQosPolicyKind::KeepLast(kept) },
        representation: plain_cdr(),
        writer_data_lifecycle: WriterDataLifecycleQosPolicy {
            autodispose_unregistered_instances: false,
        },
        ..Default::default()
    }
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

fn taken<T: TypeSupport + 'static>(reader: &DataReader<T>) -> Vec<T> {
    reader
        .take(100, ANY_SAMPLE_STATE, ANY_VIEW_STATE, ANY_INSTANCE_STATE)
        .map(|samples| samples.into_iter().filter_map(|sample| sample.data).collect())
        .unwrap_or_default() // nothing there
}

/// Prints what was not printed before, until it has all or there are no writers.
///
/// dust_dds 0.16 takes the end of any reader or writer of a participant of Cyclone DDS for the end of
/// that participant, and does not find it again: at the end of a run, say, when its readers go. What
/// was on its way is then lost, and who joins anew gets it.
fn read_until_left(subscriber: &Subscriber, participant: &DomainParticipant, wanted: &mut Wanted) {
    let points = reader!(participant, subscriber, "CalibrationResult", CalibrationResult);
    let curves = reader!(participant, subscriber, "TransferFunction", TransferFunction);
    let joined = Instant::now();
    let mut was_matched = false;
    while wanted.results > 0 || wanted.functions > 0 {
        for one in taken(&points).iter().filter(|one| one.bench == wanted.bench) {
            let key = format!("{} {} {} {}", one.run, one.channel, one.step, one.repetition);
            if wanted.printed.insert(key) {
                print_result(one);
                wanted.results = wanted.results.saturating_sub(1);
            }
        }
        for one in taken(&curves).iter().filter(|one| one.bench == wanted.bench) {
            if wanted.printed.insert(format!("{} {}", one.run, one.channel)) {
                print_function(one);
                wanted.functions = wanted.functions.saturating_sub(1);
            }
        }
        let matched = !curves.get_matched_publications().unwrap().is_empty();
        let is_another = curves.get_subscription_matched_status().unwrap().total_count > 1;
        if is_another || !matched && (was_matched || joined.elapsed() > LONGEST_DISCOVERY) {
            return;
        }
        was_matched = matched;
        std::thread::sleep(BLOCK);
    }
}

struct Wanted {
    bench: String,
    results: usize,
    functions: usize,
    printed: HashSet<String>,
}

fn read(domain: DomainId, partition: &PartitionQosPolicy, mut wanted: Wanted) {
    while wanted.results > 0 || wanted.functions > 0 {
        let participant = join(domain);
        let qos = SubscriberQos { partition: partition.clone(), ..Default::default() };
        let subscriber =
            participant.create_subscriber(QosKind::Specific(qos), NO_LISTENER, NO_STATUS).unwrap();
        read_until_left(&subscriber, &participant, &mut wanted);
        participant.delete_contained_entities().unwrap();
        DomainParticipantFactory::get_instance().delete_participant(&participant).unwrap();
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

fn write(participant: &DomainParticipant, publisher: &Publisher, bench: &str, seconds: f64) {
    let descriptions = writer!(participant, publisher, "SourceDescription", SourceDescription, 1);
    let blocks = writer!(participant, publisher, "AcsSamples", SampleBlock, 250);
    let since_1970 = std::time::UNIX_EPOCH.elapsed().unwrap();
    let session = since_1970.as_nanos() as u64;
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
    std::thread::sleep(std::time::Duration::from_secs(3)); // repairs of the last blocks
}

fn join(domain: DomainId) -> DomainParticipant {
    DomainParticipantFactory::get_instance()
        .create_participant(domain, QosKind::Default, NO_LISTENER, NO_STATUS)
        .unwrap()
}

fn main() {
    let words: Vec<String> = std::env::args().collect();
    let domain = words[2].parse().unwrap();
    let partition = PartitionQosPolicy { name: vec![words[3].clone()] };
    if words[1] == "write" {
        let participant = join(domain);
        let qos = PublisherQos { partition, ..Default::default() };
        let publisher =
            participant.create_publisher(QosKind::Specific(qos), NO_LISTENER, NO_STATUS).unwrap();
        write(&participant, &publisher, &words[4], words[5].parse().unwrap());
    } else {
        let wanted = Wanted {
            bench: words[4].clone(),
            results: words[5].parse().unwrap(),
            functions: words[6].parse().unwrap(),
            printed: HashSet::new(),
        };
        read(domain, &partition, wanted);
    }
}
