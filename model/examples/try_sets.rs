use pinswitch_model::inference::*; use pinswitch_model::rig::*;
fn main(){ for path in std::env::args().skip(1){ let t=PlateauTable::read(std::fs::File::open(&path).unwrap(),&path).unwrap();
 let t0=std::time::Instant::now();
 let frame=Frame::new(&t.rows); let mut obs=Observations::new(&frame,&t.rows).unwrap();
 let s=select(&Model::baseline(frame.clone()),&mut obs,Levels::default());
 let el=t0.elapsed();
 let fresh=path.replace(".csv","-fresh.csv"); let mut e=(0.0,0.0);
 if let Ok(f)=std::fs::File::open(&fresh){ let f=PlateauTable::read(f,&fresh).unwrap(); let p=frame.points(&f.rows).unwrap();
  let rm=|m:&Model| { let q=m.predict(&p); (q.iter().zip(&f.rows).map(|(a,r)|(a-r.force_n).powi(2)).sum::<f64>()/p.len() as f64).sqrt()};
  e=(rm(&s.baseline.model),rm(&s.augmented.model)); }
 println!("{} noise {:.4} {:.5} ser {:.4} {:.5} conv {} {} [{:.2?}] fresh {:.4} -> {:.4} ratio {:.3}",&path[path.len()-10..],s.noise.repetition.constant_n,s.noise.repetition.per_load,s.noise.series.constant_n,s.noise.series.per_load,s.baseline.converged,s.augmented.converged,el,e.0,e.1,e.1/e.0);
 println!("   costs {:.0} {:.0} n {}  cand {:?}",s.baseline.cost,s.augmented.cost,obs.points.len(),s.candidates.iter().take(4).map(|c|format!("{} {:.0}",c.0,c.1)).collect::<Vec<_>>());
 for t in &s.augmented.model.terms { if let Term::Structure(x)=t {println!("   S {}",x.describe(&frame));} }
 println!("   {:?}", s.augmented.model.names().iter().zip(s.augmented.model.values()).skip(8).map(|(n,v)|format!("{}={:.4}",n.0,v)).collect::<Vec<_>>());
 println!("   gains {:?} rivals {:?} struct {:?}",s.gains,s.rivals.iter().map(|r|r.iter().map(|x|format!("{} +{:.1} cos {:.3}",x.effect.id(),x.worse_by,x.cosine)).collect::<Vec<_>>()).collect::<Vec<_>>(),s.structure);
}}
