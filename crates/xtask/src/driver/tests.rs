//! The judgement on lists, then the search on a directory that stands for `/`.

use super::*;

fn found(loader: bool, names: &[&str], render_node: bool, nvidia_device: bool) -> Found {
    let manifests =
        names.iter().map(|name| Manifest { name: (*name).into(), library_exists: true }).collect();
    Found { loader, manifests, render_node, nvidia_device }
}

#[test]
fn a_bare_machine_lacks_both() {
    assert_eq!(found(false, &[], false, false).missing(), [Missing::Loader, Missing::Driver]);
}

#[test]
fn a_software_driver_needs_no_device() {
    for name in ["lvp_icd.x86_64.json", "lvp_icd.json", "vk_swiftshader_icd.json"] {
        assert_eq!(found(true, &[name], false, false).missing(), [], "{name}");
        assert_eq!(found(false, &[name], false, false).missing(), [Missing::Loader], "{name}");
    }
}

#[test]
fn a_hardware_driver_needs_its_device() {
    let mesa = ["intel_icd.x86_64.json", "radeon_icd.x86_64.json"];
    assert_eq!(found(true, &mesa, false, false).missing(), [Missing::Driver]);
    assert_eq!(found(true, &mesa, true, false).missing(), []);
    assert_eq!(
        found(true, &mesa, false, true).missing(),
        [Missing::Driver],
        "an NVIDIA card needs its own driver"
    );
    assert_eq!(found(true, &["nvidia_icd.json"], false, true).missing(), []);
    assert_eq!(found(true, &["nvidia_icd.json"], true, false).missing(), [Missing::Driver]);
}

#[test]
fn a_manifest_without_its_library_does_not_count() {
    let mut machine = found(true, &["lvp_icd.x86_64.json"], false, false);
    machine.manifests[0].library_exists = false;
    assert_eq!(machine.missing(), [Missing::Driver]);
}

#[test]
fn the_library_is_read_from_a_manifest() {
    let of =
        |value: &str| library_path(&format!(r#"{{ "ICD": {{ "library_path" : "{value}", "x": "y" }} }}"#));
    assert_eq!(of("/usr/lib/libvulkan_lvp.so").as_deref(), Some("/usr/lib/libvulkan_lvp.so"));
    assert_eq!(of("libGLX_nvidia.so.0").as_deref(), Some("libGLX_nvidia.so.0"));
    for broken in ["", "{}", r#""library_path""#, r#""library_path": 3"#, r#""library_path": "abc"#] {
        assert_eq!(library_path(broken), None, "{broken}");
    }
}

/// A directory that stands for `/`, removed at the end of the test.
struct Root(PathBuf);

impl Root {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("xtask-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, path: &str, text: &str) -> &Self {
        let file = self.0.join(path);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, text).unwrap();
        self
    }

    fn missing(&self) -> Vec<Missing> {
        survey(&Machine::at(&self.0)).missing()
    }
}

impl Drop for Root {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const LAVAPIPE: &str =
    r#"{"ICD": {"library_path": "/usr/lib/libvulkan_lvp.so"}, "file_format_version": "1.0.0"}"#;

#[test]
fn the_search_finds_what_is_put_in_place_step_by_step() {
    let root = Root::new("lavapipe");
    assert_eq!(root.missing(), [Missing::Loader, Missing::Driver]);
    root.write("usr/lib64/libvulkan.so.1", "");
    assert_eq!(root.missing(), [Missing::Driver]);
    root.write("usr/share/vulkan/icd.d/lvp_icd.x86_64.json", LAVAPIPE);
    assert_eq!(root.missing(), [Missing::Driver], "the manifest's library is still absent");
    root.write("usr/lib/libvulkan_lvp.so", "");
    assert_eq!(root.missing(), []);
}

#[test]
fn a_card_counts_once_its_render_node_is_there() {
    let root = Root::new("card");
    root.write("usr/lib/libvulkan.so.1", "").write("usr/lib/libvulkan_intel.so", "");
    root.write("etc/vulkan/icd.d/intel_icd.json", r#"{"ICD": {"library_path": "libvulkan_intel.so"}}"#);
    assert_eq!(root.missing(), [Missing::Driver]);
    root.write("dev/dri/card0", "");
    assert_eq!(root.missing(), [Missing::Driver], "a display node cannot render");
    root.write("dev/dri/renderD128", "");
    assert_eq!(root.missing(), []);
}

#[test]
fn named_driver_files_replace_the_search() {
    let root = Root::new("named");
    root.write("usr/lib/libvulkan.so.1", "").write("usr/lib/libvulkan_lvp.so", "");
    root.write("usr/share/vulkan/icd.d/lvp_icd.json", LAVAPIPE);
    root.write(
        "opt/swiftshader/vk_swiftshader_icd.json",
        r#"{"ICD": {"library_path": "./libvk_swiftshader.so"}}"#,
    );
    let mut machine = Machine::at(&root.0);
    machine.driver_files = Some(vec!["/opt/swiftshader/vk_swiftshader_icd.json".into()]);
    assert_eq!(
        survey(&machine).missing(),
        [Missing::Driver],
        "its library is absent, and lavapipe is not asked"
    );
    root.write("opt/swiftshader/libvk_swiftshader.so", "");
    assert_eq!(survey(&machine).missing(), []);
}

#[test]
fn the_linker_cache_is_believed() {
    let root = Root::new("cache");
    let mut machine = Machine::at(&root.0);
    machine.linker_cache = "\tlibvulkan.so.1 (libc6,x86-64) => /opt/vulkan/libvulkan.so.1\n".into();
    assert!(machine.has_library(LOADER));
    assert!(!machine.has_library("libvulkan.so"), "a prefix of a name is another library");
}
